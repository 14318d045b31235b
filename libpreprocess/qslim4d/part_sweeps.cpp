#include "libpreprocess/qslim4d/part_sweeps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"
#include "libpreprocess/outofcore/record_files.h"
#include "libpreprocess/qslim4d/cell_targets.h"
#include "libpreprocess/qslim4d/scatter.h"
#include "libpreprocess/qslim4d/sweep.h"

namespace tet4d::qslim4d {
namespace {

// Barycentres that decide where cells are cut: so many for each cell, and in all.
constexpr std::uint64_t kSamplesPerCell = 1024, kLeastSamples = std::uint64_t{1} << 16,
                        kMostSamples = std::uint64_t{1} << 21;
constexpr double kMostReduction = 4;  // of one sweep: what is locked in it must not fall far behind
constexpr double kStuck = 0.99;       // a sweep that leaves more of its tetrahedra has nothing to take away

std::uint64_t samplesOf(std::uint64_t tets, std::uint64_t cell_tets) {
  return std::clamp(tets / std::max<std::uint64_t>(1, cell_tets) * kSamplesPerCell, kLeastSamples, kMostSamples);
}

// Bytes of a page of the input while it is scattered.
std::uint64_t pieceBytes(const hypermesh::File& file, const VertexLoad& load) {
  std::uint64_t most = 0;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const auto& counts = file.geometryEntry(k).counts;
    // Values side by side, and a column and a page of it before they are.
    most = std::max(most, file.gatherBytes(k) + (counts[1] + counts[3]) * (25 + 2 * load.bytes()) + counts[2] * 8);
  }
  return most;
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
  Sweeps(CellRun& run, const PartTry& which, const Options& options)
      : run_(run), options_(options), space_(spaceOf(run.file.header().index_to_world)) {
    task_.which = which;
    task_.metric = run.metric;
    task_.domain = run.file.header().domain;
    task_.map = run.file.header().index_to_world;
    task_.options = options;
    task_.columns = run.columns;
    task_.keep_non_manifold = run.cells.keep_non_manifold;
  }

  PartOutcome run() {
    PartOutcome outcome;
    outcome.tets = run_.pages.tets(task_.which.part);
    const double sweeps = plannedSweeps(outcome.tets);
    for (std::size_t sweep = 0;; ++sweep) {
      prepare(sweep, outcome.tets, outcome.results);
      // One cell has no seam, and is simplified to the end.
      const bool is_whole = task_.cells.size() == 1;
      const double left = is_whole ? 1 : sweeps - static_cast<double>(sweep);
      task_.targets = cellTargets(task_.cells, totalOf(outcome.tets, left));
      task_.options.most_error = errorOf(1 - left);
      outcome.most_in_flight =
          std::max(outcome.most_in_flight, runSweep(task_, run_.folder, run_.executor, run_.memory, run_.progress));
      const SweepReport swept = readSweep(sweep, outcome);
      outcome.sweeps.push_back(swept);
      outcome.tets = swept.tets_out;
      // More sweeps than planned only if they still take away what was locked in the last one.
      if (is_whole) break;
      const bool is_done = outcome.tets <= options_.target_tets;
      const bool is_stuck = static_cast<double>(outcome.tets) > kStuck * static_cast<double>(swept.tets_in);
      if (static_cast<double>(sweep) + 1 >= sweeps && (is_done || is_stuck)) break;
    }
    outcome.stats.stalled = outcome.tets > options_.target_tets;
    return outcome;
  }

 private:
  double plannedSweeps(std::uint64_t tets) const {
    if (options_.target_tets == 0) return 3;
    const double reduction = static_cast<double>(tets) / static_cast<double>(options_.target_tets);
    return reduction <= kMostReduction ? 2 : 1 + std::ceil(std::log(reduction) / std::log(kMostReduction));
  }

  // The error of a sweep. Where it is the only stop, it is reached in steps, for the reason that shares are: what is
  // locked must not fall far behind. over: sweeps beyond the last planned one.
  double errorOf(double over) const {
    return options_.target_tets == 0 && over < 0 ? options_.most_error * std::exp2(over) : options_.most_error;
  }

  // Scatters the mesh to the cells of a sweep, unless that is done.
  void prepare(std::size_t sweep, std::uint64_t tets, const std::vector<std::string>& results) {
    const CellPaths paths(run_.folder, sweep, task_.which);
    const std::string line = "scattered " + std::to_string(sweep) + task_.which.suffix();
    task_.sweep = sweep;
    if (!run_.folder.isDone(line)) {
      const PieceSource source = sweep == 0 ? pagesOfInput() : piecesOf(results);
      const auto reserved =
          run_.memory.reserve(bytesToScatter(tets, results), "buffers, and a page or a cell's result");
      const std::uint64_t pieces = sweep == 0 ? run_.pages.pages(task_.which.part).size() : results.size();
      run_.progress.phase("read", pieces);
      const std::vector<FixedPlace> sample = survey(sweep, tets, source);
      run_.progress.phase("scatter", pieces);
      std::array<double, 4> units{};
      for (std::size_t axis = 0; axis < 3; ++axis)
        units[axis] = glm::length(space_.axes[static_cast<int>(axis)]) * run_.grid.step(axis);
      units[3] = task_.speed * run_.grid.step(3);
      const CellTree tree(sample, tets, run_.cells.cell_tets, sweep % 2 == 0 ? Cuts::kHalves : Cuts::kThirds, units);
      task_.cells =
          scatter(source, tree, run_.grid, run_.file.header().vertices, run_.load(), paths, run_.buffer_bytes);
      const Plan plan{tets, task_.speed};
      outofcore::writeFile(paths.plan(), std::as_bytes(std::span(&plan, 1)));
      outofcore::appendFile(paths.plan(), std::as_bytes(std::span(task_.cells)));
      run_.folder.record(line);
    } else {
      Plan plan{};
      outofcore::readAt(paths.plan(), 0, std::as_writable_bytes(std::span(&plan, 1)));
      task_.speed = plan.speed;
      task_.cells.resize((outofcore::fileBytes(paths.plan()) - sizeof(Plan)) / sizeof(CellSize));
      outofcore::readAt(paths.plan(), sizeof(Plan), std::as_writable_bytes(std::span(task_.cells)));
    }
    run_.has_finished = true;
    // Their headers are read again when a run is resumed.
    for (const std::string& result : results) outofcore::cutFile(result, sizeof(ResultHeader));
  }

  // Every so manieth barycentre; in the first sweep the mean speed of the edges, too.
  std::vector<FixedPlace> survey(std::size_t sweep, std::uint64_t tets, const PieceSource& source) {
    const std::uint64_t stride = std::max<std::uint64_t>(1, tets / samplesOf(tets, run_.cells.cell_tets));
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
          const FixedPlace place = run_.grid.placeOf(piece.positions[v]);
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
      const std::size_t part = task_.which.part;
      const double expected =
          std::min(1.0, static_cast<double>(options_.target_tets) / static_cast<double>(run_.pages.tets(part)));
      std::uint64_t pages = 0;
      for (const std::size_t k : run_.pages.pages(part)) {
        const hypermesh::GatheredPage page = unwrap(run_.file.gather(k));
        const std::vector<std::uint64_t> ids = exchange::globalNumbers(page.view);
        refuseOtherParts(k, page.view.tets, ids);
        const std::vector<float> values = valuesOf(k, page.view, ids.size());
        visit({ids, page.positions, {}, {}, values, {}, page.view.tets, expected});
        run_.file.reader().dropResident();
        run_.progress.step(++pages);
      }
    };
  }

  void refuseOtherParts(std::size_t k, std::span<const hypermesh::Tet> tets, const std::vector<std::uint64_t>& ids) {
    if (run_.pages.parts() == 1) return;
    std::vector<std::uint8_t> is_own(ids.size());
    for (std::size_t v = 0; v < ids.size(); ++v) is_own[v] = run_.pages.owns(task_.which.part, ids[v]) ? 1 : 0;
    for (const hypermesh::Tet& tet : tets) {
      if (std::all_of(tet.begin(), tet.end(), [&](std::uint32_t v) { return is_own[v] != 0; })) continue;
      throw Error(FaultCode::kBadInput, run_.file.reader().path(), "page " + std::to_string(k),
                  "a tetrahedron has a vertex of another part", "make the file again");
    }
  }

  // The columns of a page's vertices, side by side for each.
  std::vector<float> valuesOf(std::size_t k, const hypermesh::PageView& view, std::size_t vertices) const {
    const std::size_t stride = run_.load().values;
    std::vector<float> values(vertices * stride);
    std::size_t at = 0;
    for (const PlannedColumn& column : run_.cells.columns) {
      const std::vector<float> of = unwrap(run_.file.gatherColumn(column.column, k, view));
      const std::size_t n = column.as.components;
      for (std::size_t v = 0; v < vertices; ++v) std::copy_n(of.data() + v * n, n, values.data() + v * stride + at);
      at += n;
    }
    return values;
  }

  PieceSource piecesOf(const std::vector<std::string>& results) {
    std::vector<ResultHeader> headers;
    for (const std::string& path : results) headers.push_back(readResultHeader(path));
    return [this, &results, expected = expectedShares(headers, options_.target_tets)](const VisitPiece& visit) {
      for (std::size_t i = 0; i < results.size(); ++i) {
        const CellResult result = readResult(results[i], ResultWants::kAll);
        visit(result.piece(expected[i]));
        run_.progress.step(i + 1);
      }
    };
  }

  // What all cells are to leave of `tets` in this sweep, when `left` sweeps are to come, this one among them.
  std::uint64_t totalOf(std::uint64_t tets, double left) const {
    if (left <= 1) return options_.target_tets;
    const double wanted = static_cast<double>(options_.target_tets), all = static_cast<double>(tets);
    return wanted >= all ? options_.target_tets : static_cast<std::uint64_t>(all * std::pow(wanted / all, 1 / left));
  }

  // Adds up the results of a sweep and names them.
  SweepReport readSweep(std::size_t sweep, PartOutcome& outcome) const {
    SweepReport swept{task_.cells.size(), outcome.tets, 0};
    Stats& stats = outcome.stats;
    outcome.results.clear();
    for (std::size_t i = 0; i < task_.cells.size(); ++i) {
      outcome.results.push_back(CellPaths(run_.folder, sweep, task_.which).result(i));
      const ResultHeader header = readResultHeader(outcome.results.back());
      swept.tets_out += header.tets;
      stats.collapses += header.stats.collapses;
      stats.aligned += header.stats.aligned;
      for (std::size_t v = 0; v < stats.verdicts.size(); ++v) stats.verdicts[v] += header.stats.verdicts[v];
      stats.rounds += header.stats.rounds;
      stats.largest_error = std::max(stats.largest_error, header.stats.largest_error);
      outcome.non_manifold.triangles += header.non_manifold.triangles;
      outcome.non_manifold.vertices += header.non_manifold.vertices;
    }
    return swept;
  }

  std::uint64_t bytesToScatter(std::uint64_t tets, const std::vector<std::string>& results) const {
    if (results.empty()) return scatterBytes(run_.file, run_.cells.cell_tets, run_.load(), run_.buffer_bytes);
    return fixedBytes(run_.file.header().vertices, tets, run_.cells.cell_tets, run_.buffer_bytes) +
           largestResult(results, run_.load());
  }

  CellRun& run_;
  const Options& options_;
  Space space_;
  SweepTask task_;
};

}  // namespace

PartOutcome sweepPart(CellRun& run, const PartTry& which, const Options& options) {
  return Sweeps(run, which, options).run();
}

std::uint64_t scatterBytes(const hypermesh::File& file, std::uint64_t cell_tets, const VertexLoad& load,
                           std::size_t buffer_bytes) {
  return fixedBytes(file.header().vertices, file.header().tets, cell_tets, buffer_bytes) + pieceBytes(file, load);
}

std::uint64_t resultBytes(std::uint64_t vertices, std::uint64_t tets, const VertexLoad& load) {
  return vertices * (sizeof(CellQuadric) + sizeof(Vec4f) + 25 + load.bytes()) + tets * (sizeof(hypermesh::Tet) + 8);
}

std::uint64_t largestResult(const std::vector<std::string>& results, const VertexLoad& load) {
  std::uint64_t most = 0;
  for (const std::string& path : results) {
    const ResultHeader header = readResultHeader(path);
    most = std::max(most, resultBytes(header.vertices, header.tets, load));
  }
  return most;
}

}  // namespace tet4d::qslim4d
