#include "libpreprocess/qslim4d/cells.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/record_files.h"
#include "libpreprocess/qslim4d/part_sweeps.h"
#include "libpreprocess/qslim4d/promise.h"
#include "libpreprocess/qslim4d/stream_writer.h"
#include "libpreprocess/qslim4d/sweep.h"

namespace tet4d::qslim4d {
namespace {

constexpr std::uint64_t kLeastBuffers = std::uint64_t{4} << 20, kMostBuffers = std::uint64_t{64} << 20;

// What came of a try, as its file in the folder tells a resumed run.
struct Confirmed {
  Confirmation by;
  std::uint64_t is_enough;
};

class Cells {
 public:
  Cells(const hypermesh::File& file, Metric metric, const Options& options, const CellOptions& cells,
        hypermesh::Writer& writer, outofcore::Executor& executor, outofcore::MemoryBudget& memory,
        outofcore::Progress& progress)
      : options_(options),
        writer_(writer),
        folder_(cells.folder, cells.run_name, cells.resume),
        pages_(file),
        run_{file,
             metric,
             cells,
             executor,
             memory,
             progress,
             folder_,
             pages_,
             {},
             FixedGrid(file.header().bounds),
             std::clamp(memory.available() / 8, kLeastBuffers, kMostBuffers)} {
    for (const PlannedColumn& column : cells.columns) run_.columns.push_back(column.as);
  }

  CellReport run() {
    try {
      return simplifyAll();
    } catch (const Error& error) {
      const FaultCode code = error.fault().code;
      const bool passes =
          code == FaultCode::kInterrupted || code == FaultCode::kNoSpace || code == FaultCode::kOutOfMemory;
      if (!passes || !run_.has_finished) throw;
      leaveFolder(error.fault());
    } catch (const std::bad_alloc&) {
      if (!run_.has_finished) throw;
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

  CellReport simplifyAll() {
    CellReport report;
    report.is_resumed = folder_.isResumed();
    std::vector<PartResults> parts(pages_.parts());
    for (std::size_t part = 0; part < parts.size() && report.is_kept; ++part) {
      if (pages_.tets(part) == 0) continue;
      Options options = options_;
      if (!run_.cells.targets.empty()) options.target_tets = run_.cells.targets[part];
      const PartOutcome outcome =
          run_.cells.promise ? underPromise(part, options, parts[part], report) : sweepPart(run_, {part, 0}, options);
      parts[part].paths = outcome.results;
      parts[part].error_estimated = outcome.stats.largest_error;
      addUp(outcome, report);
    }
    if (!report.is_kept) return report;
    const WrittenMesh written = write(parts, run_.columns, writer_);
    report.vertices = written.vertices, report.tets = written.tets;
    return report;
  }

  static void addUp(const PartOutcome& outcome, CellReport& report) {
    Stats& stats = report.stats;
    stats.collapses += outcome.stats.collapses;
    stats.aligned += outcome.stats.aligned;
    for (std::size_t v = 0; v < stats.verdicts.size(); ++v) stats.verdicts[v] += outcome.stats.verdicts[v];
    stats.rounds += outcome.stats.rounds;
    stats.largest_error = std::max(stats.largest_error, outcome.stats.largest_error);
    stats.stalled = stats.stalled || outcome.stats.stalled;
    if (outcome.stats.stalled) report.stalled_tets += outcome.tets;
    report.sweeps.resize(std::max(report.sweeps.size(), outcome.sweeps.size()));
    for (std::size_t i = 0; i < outcome.sweeps.size(); ++i) {
      report.sweeps[i].cells += outcome.sweeps[i].cells;
      report.sweeps[i].tets_in += outcome.sweeps[i].tets_in;
      report.sweeps[i].tets_out += outcome.sweeps[i].tets_out;
    }
    report.most_in_flight = std::max(report.most_in_flight, outcome.most_in_flight);
    report.non_manifold.triangles += outcome.non_manifold.triangles;
    report.non_manifold.vertices += outcome.non_manifold.vertices;
  }

  WrittenMesh write(std::span<const PartResults> parts, std::span<const SlimColumn> columns,
                    hypermesh::Writer& writer) {
    const VertexLoad load = loadOf(columns);
    std::uint64_t most = 0, vertices = 0, tets = 0;
    for (const PartResults& part : parts) {
      most = std::max(most, largestResult(part.paths, load));
      for (const std::string& path : part.paths) {
        const ResultHeader header = readResultHeader(path);
        vertices += header.vertices, tets += header.tets;
      }
    }
    const auto reserved = run_.memory.reserve(
        std::max(sortBytes(vertices, load, run_.buffer_bytes) + most, writtenPageBytes(vertices, tets)),
        "results of a cell, and buffers");
    return writeResults(parts, columns, writer, folder_, run_.buffer_bytes, run_.progress);
  }

  // Tries until the promise is kept, which the best of them did, or not.
  PartOutcome underPromise(std::size_t part, const Options& options, PartResults& written, CellReport& report) {
    const CellPromise& promise = *run_.cells.promise;
    std::vector<double> broken_at;
    std::optional<PartTry> best;
    std::optional<PartOutcome> held;  // of the best; none if the journal knows of it
    PartTry which{part, 0};
    const auto optionsFor = [&](double estimate) {
      Options tried = options;
      tried.most_error = std::min(estimate, options.most_error);
      return tried;
    };
    const PromiseOutcome outcome = keepPromise(promise.world, promise.most_tries, [&](double estimate) {
      const std::string line = "confirmed" + which.suffix();
      const std::string path = folder_.file("sweeps" + which.suffix() + ".confirmed");
      Confirmed confirmed{};
      std::optional<PartOutcome> tried;
      if (folder_.isDone(line)) {
        outofcore::readAt(path, 0, std::as_writable_bytes(std::span(&confirmed, 1)));
      } else {
        tried = sweepPart(run_, which, optionsFor(estimate));
        confirmed.by = confirm(part, *tried, broken_at);
        const bool is_at_target = options.target_tets > 0 && !tried->stats.stalled;
        confirmed.is_enough = is_at_target || estimate >= options.most_error ? 1 : 0;
        outofcore::writeFile(path, std::as_bytes(std::span(&confirmed, 1)));
        folder_.record(line);
      }
      if (confirmed.by.within) {
        if (held) removeResults(*held);
        best = which, held = std::move(tried);
      } else {
        broken_at.push_back(confirmed.by.frame);
        if (tried) removeResults(*tried);
      }
      ++which.number;
      return Attempt{confirmed.by.bound, confirmed.by.within, confirmed.is_enough != 0};
    });
    report.tries += outcome.tries;
    report.is_kept = outcome.kept;
    report.bound = outcome.kept ? std::max(report.bound, outcome.measured) : outcome.measured;
    report.estimate = std::min({report.estimate, outcome.estimate, options.most_error});
    if (!outcome.kept) return {};
    written.error_measured = outcome.measured;
    // What the journal lists is only read again.
    return held ? std::move(*held) : sweepPart(run_, *best, optionsFor(outcome.estimate));
  }

  static void removeResults(const PartOutcome& outcome) {
    for (const std::string& path : outcome.results) outofcore::removeFile(path);
  }

  // Writes what the cells of a part have left as a file for the measure.
  Confirmation confirm(std::size_t part, const PartOutcome& outcome, const std::vector<double>& broken_at) {
    const std::string path = folder_.file("tried.t4h");
    hypermesh::MeshHeader header{};
    header.flags = run_.file.header().flags;
    header.index_to_world = run_.file.header().index_to_world;
    header.domain = run_.file.header().domain;
    header.isovalue = run_.file.header().isovalue;
    {
      hypermesh::Writer writer =
          unwrap(hypermesh::Writer::create(path, header, run_.file.times(), {}, paged::Codec::kRaw, true));
      const PartResults results{outcome.results};
      write({&results, 1}, {}, writer);
      unwrap(writer.close("{}"));
    }
    const hypermesh::File tried = unwrap(hypermesh::File::open(path));
    const Confirmation confirmation = run_.cells.promise->confirm(tried, part, broken_at);
    outofcore::removeFile(path);
    return confirmation;
  }

  const Options& options_;
  hypermesh::Writer& writer_;
  outofcore::WorkFolder folder_;
  PartPages pages_;
  CellRun run_;
};

VertexLoad loadOfWishes(const hypermesh::File& file, std::span<const ColumnWish> wishes) {
  std::vector<SlimColumn> columns;
  for (const ColumnWish& wish : wishes) {
    columns.emplace_back();
    columns.back().components = file.columns()[wish.column].components;
    columns.back().weight = wish.in_metric ? 1 : 0;
  }
  return loadOf(columns);
}

}  // namespace

std::uint64_t boundCellMemory(const hypermesh::File& file, std::uint64_t cell_tets,
                              std::span<const ColumnWish> columns) {
  const hypermesh::MeshHeader& header = file.header();
  const VertexLoad load = loadOfWishes(file, columns);
  const std::uint64_t tets = std::min(header.tets, cell_tets + cell_tets / 8);
  const auto vertices =
      static_cast<std::uint64_t>(std::ceil(1.25 * static_cast<double>(tets) * static_cast<double>(header.vertices) /
                                           static_cast<double>(std::max<std::uint64_t>(1, header.tets))));
  const std::uint64_t sorting = sortBytes(header.vertices, load, kLeastBuffers) + resultBytes(vertices, tets, load);
  return std::max({cellBytes({tets, 2 * vertices, vertices, 0, 0}, load),
                   scatterBytes(file, cell_tets, load, kLeastBuffers), sorting,
                   writtenPageBytes(header.vertices, header.tets)});
}

std::uint64_t boundTemporaryBytes(const hypermesh::File& file, std::span<const ColumnWish> columns, bool promised) {
  const hypermesh::MeshHeader& header = file.header();
  const VertexLoad load = loadOfWishes(file, columns);
  // What is scattered, and the results of the sweep before. Values stand with every use of a vertex.
  const std::uint64_t once =
      header.tets * 2 * sizeof(hypermesh::Tet) +
      header.vertices * (4 * sizeof(CellVertex) + 2 * sizeof(CellQuadric) + 64 + 4 * load.bytes());
  // Beside a try the best one's results, and a try as a file.
  const std::uint64_t tries = header.vertices * (sizeof(CellQuadric) + 2 * sizeof(Vec4f) + 9 + load.bytes()) +
                              header.tets * (2 * sizeof(hypermesh::Tet) + 32);
  return once + (promised ? tries : 0);
}

CellReport simplifyInCells(const hypermesh::File& file, Metric metric, const Options& options, const CellOptions& cells,
                           hypermesh::Writer& writer, outofcore::Executor& executor, outofcore::MemoryBudget& memory,
                           outofcore::Progress& progress) {
  return Cells(file, metric, options, cells, writer, executor, memory, progress).run();
}

}  // namespace tet4d::qslim4d
