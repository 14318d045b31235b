#include "libpreprocess/qslim4d/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"
#include "libpreprocess/outofcore/record_files.h"
#include "libpreprocess/qslim4d/cell_targets.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/stream_writer.h"
#include "libpreprocess/qslim4d/sweep.h"

namespace tet4d::qslim4d {
namespace {

// Barycentres that decide where cells are cut: so many for each cell, and in all.
constexpr std::uint64_t kSamplesPerCell = 1024, kLeastSamples = std::uint64_t{1} << 16,
                        kMostSamples = std::uint64_t{1} << 21;
constexpr std::uint64_t kLeastBuffers = std::uint64_t{4} << 20, kMostBuffers = std::uint64_t{64} << 20;
constexpr double kMostReduction = 4;  // of one sweep: what is locked in it must not fall far behind
constexpr double kStuck = 0.99;       // a sweep that leaves more of its tetrahedra has nothing to take away

std::uint64_t samplesOf(std::uint64_t tets, std::uint64_t cell_tets) {
  return std::clamp(tets / std::max<std::uint64_t>(1, cell_tets) * kSamplesPerCell, kLeastSamples, kMostSamples);
}

// Bytes of a page of the input while it is scattered.
std::uint64_t pieceBytes(const hypermesh::File& file) {
  std::uint64_t most = 0;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const auto& counts = file.geometryEntry(k).counts;
    most = std::max(most, file.gatherBytes(k) + (counts[1] + counts[3]) * 25 + counts[2] * 8);
  }
  return most;
}

std::uint64_t resultBytes(std::uint64_t vertices, std::uint64_t tets) {
  return vertices * (sizeof(CellQuadric) + sizeof(Vec4f) + 25) + tets * (sizeof(hypermesh::Tet) + 8);
}

// Buffers, samples, and first users of vertices while a mesh is scattered.
std::uint64_t fixedBytes(std::uint64_t vertices, std::uint64_t tets, std::uint64_t cell_tets,
                         std::uint64_t buffer_bytes) {
  const std::uint64_t samples = std::min(tets, 2 * samplesOf(tets, cell_tets)) * sizeof(FixedPlace);
  return buffer_bytes + std::max(samples, rangeBytes(vertices));
}

// What is known of a sweep once its mesh is scattered.
struct Plan {
  std::uint64_t tets_in;
  double speed;
};

class Sweeps {
 public:
  Sweeps(const hypermesh::File& file, Metric metric, const Options& options, const CellOptions& cells,
         hypermesh::Writer& writer, outofcore::Executor& executor, outofcore::MemoryBudget& memory,
         outofcore::Progress& progress)
      : file_(file),
        options_(options),
        cells_(cells),
        writer_(writer),
        executor_(executor),
        memory_(memory),
        progress_(progress),
        grid_(file.header().bounds),
        space_(spaceOf(file.header().index_to_world)),
        buffer_bytes_(std::clamp(memory.available() / 8, kLeastBuffers, kMostBuffers)),
        folder_(cells.folder, cells.run_name, cells.resume) {
    task_.metric = metric;
    task_.domain = file.header().domain;
    task_.map = file.header().index_to_world;
    task_.options = options;
  }

  CellReport run() {
    try {
      return sweepAll();
    } catch (const Error& error) {
      const FaultCode code = error.fault().code;
      const bool passes =
          code == FaultCode::kInterrupted || code == FaultCode::kNoSpace || code == FaultCode::kOutOfMemory;
      if (!passes || !has_finished_) throw;
      leaveFolder(error.fault());
    } catch (const std::bad_alloc&) {
      if (!has_finished_) throw;
      leaveFolder({FaultCode::kOutOfMemory, "", "", "the machine's memory is used up", ""});
    }
  }

 private:
  [[noreturn]] void leaveFolder(Fault fault) {
    folder_.keep();
    fault.remedy += (fault.remedy.empty() ? "" : "; ") + ("what is done is kept in " + folder_.path()) +
                    ": the same command with --resume goes on from there";
    throw Error(fault);
  }

  CellReport sweepAll() {
    CellReport report;
    std::uint64_t tets = file_.header().tets;
    const double sweeps = plannedSweeps();
    std::vector<std::string> results;  // of the sweep before
    for (std::size_t sweep = 0;; ++sweep) {
      prepare(sweep, tets, results);
      task_.targets = cellTargets(task_.cells, totalOf(tets, sweeps - static_cast<double>(sweep)));
      task_.options.most_error = errorOf(static_cast<double>(sweep) + 1 - sweeps);
      report.most_in_flight = std::max(report.most_in_flight, runSweep(task_, folder_, executor_, memory_, progress_));
      const SweepReport swept = readSweep(sweep, tets, results, report.stats);
      report.sweeps.push_back(swept);
      tets = swept.tets_out;
      // One cell has no seam, and was simplified to the end. More sweeps than planned only if they still take away what
      // was locked in the last one.
      if (sweep > 0 && swept.cells == 1) break;
      const bool is_done = tets <= options_.target_tets;
      const bool is_stuck = static_cast<double>(tets) > kStuck * static_cast<double>(swept.tets_in);
      if (static_cast<double>(sweep) + 1 >= sweeps && (is_done || is_stuck)) break;
    }
    report.stats.stalled = tets > options_.target_tets;
    const auto reserved = memory_.reserve(writeBytes(results), "results of a cell, and buffers");
    const WrittenMesh written =
        writeResults(results, report.stats.largest_error, writer_, folder_, buffer_bytes_, progress_);
    report.vertices = written.vertices, report.tets = written.tets;
    return report;
  }

  double plannedSweeps() const {
    if (options_.target_tets == 0) return 3;
    const double reduction = static_cast<double>(file_.header().tets) / static_cast<double>(options_.target_tets);
    return reduction <= kMostReduction ? 2 : 1 + std::ceil(std::log(reduction) / std::log(kMostReduction));
  }

  // The error of a sweep. Where it is the only stop, it is reached in steps, for the reason that shares are: what is
  // locked must not fall far behind. over: sweeps beyond the last planned one.
  double errorOf(double over) const {
    return options_.target_tets == 0 && over < 0 ? options_.most_error * std::exp2(over) : options_.most_error;
  }

  // Scatters the mesh to the cells of a sweep, unless that is done.
  void prepare(std::size_t sweep, std::uint64_t tets, const std::vector<std::string>& results) {
    const CellPaths paths(folder_, sweep);
    const std::string line = "scattered " + std::to_string(sweep);
    task_.sweep = sweep;
    if (!folder_.isDone(line)) {
      const PieceSource source = sweep == 0 ? pagesOfInput() : piecesOf(results);
      const auto reserved = memory_.reserve(scatterBytes(tets, results), "buffers, and a page or a cell's result");
      const std::uint64_t pieces = sweep == 0 ? file_.geometryPages() : results.size();
      progress_.phase("read", pieces);
      const std::vector<FixedPlace> sample = survey(sweep, tets, source);
      progress_.phase("scatter", pieces);
      std::array<double, 4> units{};
      for (std::size_t axis = 0; axis < 3; ++axis)
        units[axis] = glm::length(space_.axes[static_cast<int>(axis)]) * grid_.step(axis);
      units[3] = task_.speed * grid_.step(3);
      const CellTree tree(sample, tets, cells_.cell_tets, sweep % 2 == 0 ? Cuts::kHalves : Cuts::kThirds, units);
      task_.cells = scatter(source, tree, grid_, file_.header().vertices, paths, buffer_bytes_);
      const Plan plan{tets, task_.speed};
      outofcore::writeFile(paths.plan(), std::as_bytes(std::span(&plan, 1)));
      outofcore::appendFile(paths.plan(), std::as_bytes(std::span(task_.cells)));
      folder_.record(line);
    } else {
      Plan plan{};
      outofcore::readAt(paths.plan(), 0, std::as_writable_bytes(std::span(&plan, 1)));
      task_.speed = plan.speed;
      task_.cells.resize((outofcore::fileBytes(paths.plan()) - sizeof(Plan)) / sizeof(CellSize));
      outofcore::readAt(paths.plan(), sizeof(Plan), std::as_writable_bytes(std::span(task_.cells)));
    }
    has_finished_ = true;
    // Their headers are read again when a run is resumed.
    for (const std::string& result : results) outofcore::cutFile(result, sizeof(ResultHeader));
  }

  // Every so manieth barycentre; in the first sweep the mean speed of the edges, too.
  std::vector<FixedPlace> survey(std::size_t sweep, std::uint64_t tets, const PieceSource& source) {
    const std::uint64_t stride = std::max<std::uint64_t>(1, tets / samplesOf(tets, cells_.cell_tets));
    std::vector<FixedPlace> sample;
    sample.reserve(tets / stride + 1);
    double space = 0, time = 0;
    std::uint64_t sequence = 0;
    source([&](const Piece& piece) {
      for (const hypermesh::Tet& tet : piece.tets) {
        for (std::size_t i = 1; i < 4 && sweep == 0; ++i) {
          const glm::dvec4 edge = difference(piece.positions[tet[i]], piece.positions[tet[0]]);
          space += space_.length(edge);
          time += std::abs(edge.w);
        }
        if (sequence++ % stride != 0) continue;
        FixedPlace sum{};
        for (const std::uint32_t v : tet) {
          const FixedPlace place = grid_.placeOf(piece.positions[v]);
          for (std::size_t axis = 0; axis < 4; ++axis) sum[axis] += place[axis];
        }
        sample.push_back(sum);
      }
    });
    if (sweep == 0) task_.speed = speedFrom(space, time);
    return sample;
  }

  PieceSource pagesOfInput() {
    return [this](const VisitPiece& visit) {
      const double expected =
          std::min(1.0, static_cast<double>(options_.target_tets) / static_cast<double>(file_.header().tets));
      std::uint64_t pages = 0;
      exchange::forEachPage(file_, [&](const hypermesh::GatheredPage& page) {
        const std::vector<std::uint64_t> ids = exchange::globalNumbers(page.view);
        visit({ids, page.positions, {}, {}, page.view.tets, expected});
        progress_.step(++pages);
      });
    };
  }

  PieceSource piecesOf(const std::vector<std::string>& results) {
    std::vector<ResultHeader> headers;
    for (const std::string& path : results) headers.push_back(readResultHeader(path));
    return [this, &results, expected = expectedShares(headers, options_.target_tets)](const VisitPiece& visit) {
      for (std::size_t i = 0; i < results.size(); ++i) {
        const CellResult result = readResult(results[i], true);
        visit(result.piece(expected[i]));
        progress_.step(i + 1);
      }
    };
  }

  // What all cells are to leave of `tets` in this sweep, when `left` sweeps are to come, this one among them.
  std::uint64_t totalOf(std::uint64_t tets, double left) const {
    if (left <= 1 || (task_.sweep > 0 && task_.cells.size() == 1)) return options_.target_tets;
    const double wanted = static_cast<double>(options_.target_tets), all = static_cast<double>(tets);
    return wanted >= all ? options_.target_tets : static_cast<std::uint64_t>(all * std::pow(wanted / all, 1 / left));
  }

  // Adds up the results of a sweep and names them.
  SweepReport readSweep(std::size_t sweep, std::uint64_t tets, std::vector<std::string>& results, Stats& stats) const {
    SweepReport swept{task_.cells.size(), tets, 0};
    results.clear();
    for (std::size_t i = 0; i < task_.cells.size(); ++i) {
      results.push_back(CellPaths(folder_, sweep).result(i));
      const ResultHeader header = readResultHeader(results.back());
      swept.tets_out += header.tets;
      stats.collapses += header.stats.collapses;
      stats.aligned += header.stats.aligned;
      for (std::size_t v = 0; v < stats.verdicts.size(); ++v) stats.verdicts[v] += header.stats.verdicts[v];
      stats.rounds += header.stats.rounds;
      stats.largest_error = std::max(stats.largest_error, header.stats.largest_error);
    }
    return swept;
  }

  std::uint64_t scatterBytes(std::uint64_t tets, const std::vector<std::string>& results) const {
    return fixedBytes(file_.header().vertices, tets, cells_.cell_tets, buffer_bytes_) +
           (results.empty() ? pieceBytes(file_) : largestResult(results));
  }
  std::uint64_t writeBytes(const std::vector<std::string>& results) const {
    return 2 * buffer_bytes_ + largestResult(results);
  }
  static std::uint64_t largestResult(const std::vector<std::string>& results) {
    std::uint64_t most = 0;
    for (const std::string& path : results) {
      const ResultHeader header = readResultHeader(path);
      most = std::max(most, resultBytes(header.vertices, header.tets));
    }
    return most;
  }

  const hypermesh::File& file_;
  const Options& options_;
  const CellOptions& cells_;
  hypermesh::Writer& writer_;
  outofcore::Executor& executor_;
  outofcore::MemoryBudget& memory_;
  outofcore::Progress& progress_;
  FixedGrid grid_;
  Space space_;
  std::size_t buffer_bytes_;
  outofcore::WorkFolder folder_;
  SweepTask task_;
  bool has_finished_ = false;  // something that a later run can go on with
};

}  // namespace

std::uint64_t boundCellMemory(const hypermesh::File& file, std::uint64_t cell_tets) {
  const hypermesh::MeshHeader& header = file.header();
  const std::uint64_t tets = std::min(header.tets, cell_tets + cell_tets / 8);
  const auto vertices =
      static_cast<std::uint64_t>(std::ceil(1.25 * static_cast<double>(tets) * static_cast<double>(header.vertices) /
                                           static_cast<double>(std::max<std::uint64_t>(1, header.tets))));
  const std::uint64_t scattering =
      fixedBytes(header.vertices, header.tets, cell_tets, kLeastBuffers) + pieceBytes(file);
  const std::uint64_t writing = 2 * kLeastBuffers + resultBytes(vertices, tets);
  return std::max({cellBytes({tets, 2 * vertices, vertices, 0, 0}), scattering, writing});
}

std::uint64_t boundTemporaryBytes(const hypermesh::File& file) {
  const hypermesh::MeshHeader& header = file.header();
  // What is scattered, and the results of the sweep before.
  return header.tets * 2 * sizeof(hypermesh::Tet) +
         header.vertices * (4 * sizeof(CellVertex) + 2 * sizeof(CellQuadric) + 64);
}

namespace {

void refuseParts(const hypermesh::File& file) {
  if (const std::uint64_t parts = file.header().parts; parts > 1)
    throw Error(FaultCode::kBadInput, file.reader().path(), "",
                "has " + std::to_string(parts) + " parts, but cells hold one", "simplify it in core");
}

}  // namespace

CellReport simplifyInCells(const hypermesh::File& file, Metric metric, const Options& options, const CellOptions& cells,
                           hypermesh::Writer& writer, outofcore::Executor& executor, outofcore::MemoryBudget& memory,
                           outofcore::Progress& progress) {
  refuseParts(file);
  return Sweeps(file, metric, options, cells, writer, executor, memory, progress).run();
}

}  // namespace tet4d::qslim4d
