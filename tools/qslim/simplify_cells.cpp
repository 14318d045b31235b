#include "tools/qslim/simplify_cells.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <utility>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_bound.h"
#include "libpreprocess/qslim4d/cells.h"

namespace tet4d::qslim {
namespace {

std::string cellFolder(const cli::Session& session) {
  const std::filesystem::path output = session.options().output, dir = session.options().temp_dir;
  return ((dir.empty() ? output.parent_path() : dir) / output.filename()).string() + ".cells";
}

// Slices of a try and of the input's part, both read page by page, whatever the tries before have found.
qslim4d::CellPromise promiseOf(cli::Session& session, const hypermesh::File& file, const Options& options) {
  qslim4d::CellPromise promise;
  promise.world = *options.max_error;
  promise.most_tries = options.tries.value_or(kTries);
  promise.confirm = [&session, &file, world = promise.world](const hypermesh::File& tried, std::size_t part,
                                                             std::span<const double> broken_at) {
    std::vector<double> frames = tet4d::measure::framesAndBetween(file);
    for (const double frame : broken_at) {
      const auto at = std::find(frames.begin(), frames.end(), frame);
      if (at != frames.end()) std::rotate(frames.begin(), at, at + 1);
    }
    const auto reserved = session.memory().reserve(sliceBytes(file, frames) + sliceBytes(tried, frames),
                                                   "the slices that confirm --max-error");
    exchange::SliceWants wants;
    if (!file.parts().empty()) wants.part = part;
    const tet4d::measure::SliceBound bound = tet4d::measure::boundSlices(
        [&](double frame) { return exchange::sliceHypermesh(tried, frame); },
        [&](double frame) { return std::move(exchange::sliceHypermesh(file, frame, wants).mesh); },
        file.header().index_to_world, file.header().domain, frames, world, session.executor(), session.progress());
    return qslim4d::Confirmation{bound.bound, bound.frame, bound.within};
  };
  return promise;
}

}  // namespace

bool isLarge(const Options& options, const hypermesh::File& file) { return file.header().tets > options.cell_tets; }

std::string whyInCore(const Options& options) {
  return options.order == "heap" ? "the heap has one order for the whole mesh" : "";
}

std::uint64_t boundCellMemory(const hypermesh::File& file, const Options& options,
                              const std::vector<qslim4d::ColumnWish>& wishes) {
  // A try has no more triangles than the input.
  const std::uint64_t slices =
      options.max_error ? 2 * sliceBytes(file, tet4d::measure::framesAndBetween(file)) : std::uint64_t{0};
  return std::max(qslim4d::boundCellMemory(file, options.cell_tets, wishes), slices);
}

std::optional<Sum> simplifyCells(cli::Session& session, const hypermesh::File& file, const Options& options,
                                 const std::vector<qslim4d::ColumnWish>& wishes, const std::string& provenance,
                                 hypermesh::Writer& writer) {
  qslim4d::CellOptions cells;
  cells.cell_tets = options.cell_tets;
  cells.folder = cellFolder(session);
  cells.run_name = provenance;
  cells.resume = session.options().resume;
  cells.columns = qslim4d::planColumns(file, wishes, session.progress());
  cells.keep_non_manifold = options.non_manifold == "keep";
  if (options.max_error) cells.promise = promiseOf(session, file, options);
  const std::uint64_t tets = file.header().tets;
  for (const std::uint64_t of_part : qslim4d::tetsByPart(file))
    cells.targets.push_back(slimOptions(options, session.options().seed, of_part, tets).target_tets);
  const qslim4d::CellReport report =
      qslim4d::simplifyInCells(file, metricOf(options), slimOptions(options, session.options().seed, tets, tets), cells,
                               writer, session.executor(), session.memory(), session.progress());
  if (cells.resume && !report.is_resumed)
    session.note("--resume: nothing was left of an interrupted run, so this one began anew");
  if (!report.is_kept) {
    tellFailure(session, options, report.tries, report.bound, report.estimate);
    return std::nullopt;
  }
  std::string cut;
  for (std::size_t i = 0; i < report.sweeps.size(); ++i) {
    const qslim4d::SweepReport& sweep = report.sweeps[i];
    session.stats().count("cells_of_sweep_" + std::to_string(i + 1), sweep.cells);
    cut += (i == 0 ? "" : ", then ") + std::to_string(sweep.cells) + (sweep.cells == 1 ? " cell" : " cells") + " to " +
           std::to_string(sweep.tets_out) + " tets";
  }
  session.stats().count("cells_in_flight", report.most_in_flight);
  session.note(cut);
  Sum sum;
  sum.stats = report.stats;
  sum.tets = report.tets, sum.vertices = report.vertices, sum.tets_in = tets;
  sum.tries = options.max_error ? report.tries : 1;
  sum.stalled_tets = report.stalled_tets;
  sum.non_manifold = report.non_manifold;
  sum.bound = report.bound, sum.estimate = report.estimate;
  return sum;
}

}  // namespace tet4d::qslim
