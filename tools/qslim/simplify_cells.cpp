#include "tools/qslim/simplify_cells.h"

#include <filesystem>

#include "libpreprocess/qslim4d/cells.h"

namespace tet4d::qslim {
namespace {

std::string cellFolder(const cli::Session& session) {
  const std::filesystem::path output = session.options().output, dir = session.options().temp_dir;
  return ((dir.empty() ? output.parent_path() : dir) / output.filename()).string() + ".cells";
}

}  // namespace

bool isLarge(const Options& options, const hypermesh::File& file) { return file.header().tets > options.cell_tets; }

std::string whyInCore(const Options& options, const hypermesh::File& file,
                      const std::vector<qslim4d::ColumnWish>& wishes) {
  if (options.order == "heap") return "the heap has one order for the whole mesh";
  if (options.max_error) return "a promise is confirmed on the whole mesh";
  if (options.non_manifold == "keep") return "what is no manifold is looked for in the whole mesh";
  if (file.header().parts > 1) return "cells hold one part";
  if (!wishes.empty()) return "cells carry no columns; --columns none leaves them out";
  return {};
}

Sum simplifyCells(cli::Session& session, const hypermesh::File& file, const Options& options,
                  const std::string& provenance, hypermesh::Writer& writer) {
  qslim4d::CellOptions cells;
  cells.cell_tets = options.cell_tets;
  cells.folder = cellFolder(session);
  cells.run_name = provenance;
  cells.resume = session.options().resume;
  const std::uint64_t tets = file.header().tets;
  const qslim4d::CellReport report =
      qslim4d::simplifyInCells(file, metricOf(options), slimOptions(options, session.options().seed, tets, tets), cells,
                               writer, session.executor(), session.memory(), session.progress());
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
  sum.tets = report.tets, sum.vertices = report.vertices, sum.tets_in = tets, sum.tries = 1;
  if (report.stats.stalled) sum.stalled_tets = report.tets;
  return sum;
}

}  // namespace tet4d::qslim
