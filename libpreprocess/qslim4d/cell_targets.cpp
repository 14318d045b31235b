#include "libpreprocess/qslim4d/cell_targets.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tet4d::qslim4d {
namespace {

// No cell pays for what is locked with more than this share of what it should have in the end.
constexpr double kLeastOfExpected = 0.85;

// What is left of the free part of a cell when all is collapsed that costs up to 2^c: scale * 2^(-slope * c).
struct CostLaw {
  double now = 1;    // tetrahedra now
  double scale = 0;  // of the whole cell, as if nothing were locked
  double slope = 0;

  double leftAt(double log2_cost) const { return std::min(scale * std::exp2(-slope * log2_cost), now); }
};

// Points of the curve (log2 of cost, tetrahedra left) where shares of what went have gone, cheapest first.
std::pair<double, double> pointAt(const ResultHeader& result, double share) {
  const double free_in = static_cast<double>(result.tets_in) * result.free_share;
  const double removed = static_cast<double>(result.tets_in - result.tets);
  double below = 0;
  for (std::size_t bin = 0; bin < kCostBins; ++bin) {
    const double here = result.stats.removed[bin];
    if (here > 0 && below + here >= share * removed) {
      const double in_bin = (share * removed - below) / here;
      return {(static_cast<double>(bin) + in_bin - 320) / 2, std::max(free_in - share * removed, 0.01 * free_in)};
    }
    below += here;
  }
  return {(kCostBins - 320) / 2.0, std::max(free_in - removed, 0.01 * free_in)};
}

CostLaw lawOf(const ResultHeader& result) {
  // Of a smooth surface the cost of a vertex goes with its reach to the 7th, the number of vertices to the -3rd.
  constexpr double kSmooth = 3.0 / 7, kLeast = 0.15, kMost = 1.5;
  CostLaw law;
  law.now = static_cast<double>(result.tets);
  if (result.tets == result.tets_in || result.free_share <= 0) {
    law.scale = law.now * 1e30;  // nothing could go: nothing is expected to
    return law;
  }
  const auto [early_cost, early_left] = pointAt(result, 0.5);
  const auto [late_cost, late_left] = pointAt(result, 0.9);
  law.slope = late_cost > early_cost ? std::log2(early_left / late_left) / (late_cost - early_cost) : kSmooth;
  law.slope = std::clamp(law.slope, kLeast, kMost);
  law.scale = late_left / result.free_share * std::exp2(law.slope * late_cost);
  return law;
}

// The point of an interval where a falling function reaches a value: halved until nothing changes any more.
template <class Function>
double solve(double low, double high, double value, const Function& function) {
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) > value ? low : high) = middle;
  }
  return high;
}

}  // namespace

std::vector<double> expectedShares(const std::vector<ResultHeader>& results, std::uint64_t total) {
  std::vector<CostLaw> laws;
  for (const ResultHeader& result : results) laws.push_back(lawOf(result));
  const double cost = solve(-160, 160, static_cast<double>(total), [&](double log2_cost) {
    double left = 0;
    for (const CostLaw& law : laws) left += law.leftAt(log2_cost);
    return left;
  });
  std::vector<double> shares;
  for (const CostLaw& law : laws) shares.push_back(law.now > 0 ? law.leftAt(cost) / law.now : 1);
  return shares;
}

std::vector<std::uint64_t> cellTargets(const std::vector<CellSize>& cells, std::uint64_t total) {
  const auto keeps = [](const CellSize& cell, double factor) {
    const double tets = static_cast<double>(cell.tets);
    const double locked =
        static_cast<double>(cell.locked) / static_cast<double>(std::max<std::uint64_t>(1, cell.vertices));
    return std::min(tets, tets * locked + (1 - locked) * factor * cell.expected);
  };
  const auto sum = [&](double log2_factor) {
    double all = 0;
    for (const CellSize& cell : cells) all += keeps(cell, std::exp2(-log2_factor));
    return all;
  };
  if (total == 0) return std::vector<std::uint64_t>(cells.size(), 0);
  const double factor = std::exp2(-solve(-60, -std::log2(kLeastOfExpected), static_cast<double>(total), sum));
  std::vector<std::uint64_t> targets;
  double exact = 0;
  std::uint64_t given = 0;
  for (const CellSize& cell : cells) {
    exact += keeps(cell, factor);
    const auto until = std::max(given, static_cast<std::uint64_t>(std::floor(exact)));
    targets.push_back(until - given);
    given = until;
  }
  return targets;
}

}  // namespace tet4d::qslim4d
