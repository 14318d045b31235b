#include "libpreprocess/vpartition/cell.h"

#include <algorithm>
#include <utility>

namespace tet4d::vpartition {
namespace {

// What a cell says of its progress: nothing but that it may be interrupted.
class CellProgress final : public outofcore::Progress {
 public:
  void step(std::uint64_t /*done*/) override { outofcore::Progress::step(0); }
};

constexpr double kShare = 0.5;         // of a level to the one below it
constexpr double kLeastOfFree = 0.35;  // of what is not locked, so that it does not pay for what is

CellMesh packed(const qslim4d::SlimMesh& mesh, const std::vector<std::uint64_t>& ids) {
  CellMesh out;
  std::vector<std::uint32_t> number(mesh.positions.size(), qslim4d::kNone);
  out.tets.reserve(mesh.live_tets);
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    if (!mesh.isLive(t)) continue;
    hypermesh::Tet& tet = out.tets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t v = mesh.tets[t][i];
      if (number[v] == qslim4d::kNone) {
        number[v] = static_cast<std::uint32_t>(out.ids.size());
        out.ids.push_back(ids[v]);
        out.positions.push_back(mesh.positions[v]);
      }
      tet[i] = number[v];
    }
  }
  return out;
}

}  // namespace

double wantedShare(double locked_share) { return std::max(kShare, locked_share + (1 - locked_share) * kLeastOfFree); }

CellResult simplifyCell(CellMesh cell, const CellRules& rules, outofcore::Executor& executor) {
  CellResult result;
  result.tets_in = cell.tets.size();
  result.vertices_in = cell.ids.size();
  result.locked = static_cast<std::uint64_t>(
      std::count_if(cell.flags.begin(), cell.flags.end(), [](auto flags) { return (flags & qslim4d::kLocked) != 0; }));
  const double locked_share =
      static_cast<double>(result.locked) / static_cast<double>(std::max<std::size_t>(1, cell.ids.size()));
  qslim4d::Options options;
  options.target_tets = static_cast<std::uint64_t>(wantedShare(locked_share) * static_cast<double>(cell.tets.size()));
  const qslim4d::CellContext context{cell.flags, {}, cell.ids, rules.speed};
  qslim4d::SlimMesh mesh = qslim4d::makeSlimMesh(std::move(cell.positions), std::move(cell.tets), rules.domain,
                                                 rules.map, qslim4d::Metric::kSlice, {false, &executor, &context});
  CellProgress progress;
  const qslim4d::Stats stats = qslim4d::simplify(mesh, options, executor, progress);
  result.error_world = stats.largest_error;
  result.mesh = packed(mesh, cell.ids);
  return result;
}

}  // namespace tet4d::vpartition
