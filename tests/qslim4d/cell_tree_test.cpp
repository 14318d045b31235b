// Where the cells of a sweep are, and how many tetrahedra each keeps.
#include "libpreprocess/qslim4d/cell_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "libpreprocess/qslim4d/cell_targets.h"

namespace tet4d::qslim4d {
namespace {

// ---- where cells are

TEST(CellTree, EveryPlaceHasOneCellAndCellsAreNoLargerThanAsked) {
  std::mt19937 random(3);
  std::vector<FixedPlace> places;
  for (int i = 0; i < 40'000; ++i) {
    FixedPlace place{};
    for (std::int64_t& along : place) along = static_cast<std::int64_t>(random() % 100'000);
    place[2] /= 1000;  // many at the same place along one axis
    places.push_back(place);
  }
  for (const Cuts cuts : {Cuts::kHalves, Cuts::kThirds}) {
    const CellTree tree(places, places.size(), 1500, cuts, {1, 1, 1, 2});
    std::vector<std::uint64_t> sizes(tree.cells());
    for (const FixedPlace& place : places) ++sizes.at(tree.cellOf(place));
    EXPECT_GT(tree.cells(), 26U);
    EXPECT_LE(*std::max_element(sizes.begin(), sizes.end()), 1500U);
    EXPECT_GE(*std::min_element(sizes.begin(), sizes.end()), 400U);
  }
  const CellTree one(std::vector<FixedPlace>(1000, FixedPlace{5, 5, 5, 5}), 1000, 10, Cuts::kHalves, {1, 1, 1, 1});
  EXPECT_EQ(one.cells(), 1U) << "what lies at one place cannot be cut";
  EXPECT_EQ(CellTree({}, 0, 10, Cuts::kThirds, {1, 1, 1, 1}).cells(), 1U);
}

TEST(CellTree, PlanesOfHalvesAndThirdsAreApart) {
  std::vector<FixedPlace> line;
  for (std::int64_t i = 0; i < 60'000; ++i) line.push_back({i, 0, 0, 0});
  const auto planes = [&](Cuts cuts) {
    const CellTree tree(line, line.size(), 4000, cuts, {1, 1, 1, 1});
    std::vector<std::int64_t> at;
    for (std::size_t i = 1; i < line.size(); ++i)
      if (tree.cellOf(line[i]) != tree.cellOf(line[i - 1])) at.push_back(line[i][0]);
    return at;
  };
  const std::vector<std::int64_t> halves = planes(Cuts::kHalves), thirds = planes(Cuts::kThirds);
  ASSERT_GE(halves.size(), 15U);
  ASSERT_GE(thirds.size(), 15U);
  // In one dimension, the worst case: with four, few planes are parallel.
  std::int64_t nearest = 60'000;
  std::vector<std::int64_t> distances;
  for (const std::int64_t a : halves) {
    std::int64_t least = 60'000;
    for (const std::int64_t b : thirds) least = std::min(least, std::abs(a - b));
    nearest = std::min(nearest, least);
    distances.push_back(least);
  }
  std::sort(distances.begin(), distances.end());
  EXPECT_GT(nearest, 3750 / 20);
  EXPECT_GT(distances[distances.size() / 2], 3750 / 6) << "of a cell";
}

TEST(CellTree, FixedPlacesKeepTheOrderOfCoordinates) {
  const FixedGrid grid(Bounds4f{{-1e7F, 0, 0, 0}, {1e7F, 1e-9F, 0, 64}});
  const auto along = [&](float x, float y) { return grid.placeOf({x, y, 0, 3}); };
  EXPECT_LT(along(1e6F, 0)[0], along(std::nextafter(1e6F, 2e6F), 0)[0]);
  EXPECT_LT(along(0, 1e-10F)[1], along(0, 1.0001e-10F)[1]);
  EXPECT_EQ(along(0, 0)[2], 0);
}

// ---- how much is left

// A cell whose collapses follow left = tets * 2^(-slope * (c - begin)), c the log2 of the cost, down to `tets_out`.
ResultHeader lawful(std::uint64_t tets, std::uint64_t tets_out, double slope, double begin, double free_share = 1) {
  ResultHeader result{};
  result.tets_in = tets, result.tets = tets_out, result.free_share = free_share;
  const double free = static_cast<double>(tets) * free_share;
  const auto leftAt = [&](double c) { return free * std::exp2(-slope * std::max(0.0, c - begin)); };
  std::uint64_t removed = 0;
  for (std::size_t bin = 0; bin < kCostBins; ++bin) {
    const double end = (static_cast<double>(bin) + 1 - 320) / 2;
    const auto until = std::min(tets - tets_out, static_cast<std::uint64_t>(free - leftAt(end)));
    result.stats.removed[bin] = static_cast<std::uint32_t>(until - removed);
    removed = until;
  }
  return result;
}

TEST(CellTargets, AllCellsEndAtOneCost) {
  // The second cell's collapses cost 2^6 times as much.
  const std::vector<ResultHeader> results{lawful(1'000'000, 400'000, 0.4, -20), lawful(1'000'000, 400'000, 0.4, -14)};
  const std::vector<double> shares = expectedShares(results, 200'000);
  EXPECT_NEAR(shares[0] * 400'000 + shares[1] * 400'000, 200'000, 1);
  EXPECT_NEAR(shares[1] / shares[0], std::exp2(0.4 * 6), 0.1 * std::exp2(0.4 * 6));
  // What hangs on locked vertices goes later: the law is that of the free part, scaled to the whole.
  const std::vector<ResultHeader> locked{lawful(1'000'000, 550'000, 0.4, -20, 0.75),
                                         lawful(1'000'000, 400'000, 0.4, -20)};
  const std::vector<double> later = expectedShares(locked, 200'000);
  EXPECT_NEAR(later[0] * 550'000, 100'000, 5'000);
  EXPECT_NEAR(later[1] * 400'000, 100'000, 5'000);
}

TEST(CellTargets, CellsWhereNothingWentKeepTheirs) {
  const std::vector<double> shares =
      expectedShares({lawful(1000, 1000, 0.4, 0), lawful(100'000, 50'000, 0.4, 0)}, 20'000);
  EXPECT_EQ(shares[0], 1);
  EXPECT_NEAR(shares[1] * 50'000, 19'000, 10);
}

TEST(CellTargets, SumToWhatIsAskedForUnlessTooMuchIsLocked) {
  const auto sum = [](const std::vector<std::uint64_t>& targets) {
    return std::accumulate(targets.begin(), targets.end(), std::uint64_t{0});
  };
  // tets, slots, vertices, locked, expected
  const std::vector<CellSize> cells{
      {60'000, 0, 10'000, 1000, 6000}, {60'000, 0, 10'000, 1000, 12'000}, {6000, 0, 1000, 0, 900}};
  const std::vector<std::uint64_t> targets = cellTargets(cells, 50'000);
  EXPECT_NEAR(static_cast<double>(sum(targets)), 50'000, 2);
  EXPECT_NEAR(static_cast<double>(targets[1] - 6000), 2 * static_cast<double>(targets[0] - 6000), 5);
  EXPECT_EQ(sum(cellTargets(cells, 1'000'000)), 126'000U) << "no more than there are";
  EXPECT_EQ(sum(cellTargets(cells, 0)), 0U);
  // A third is locked: the free parts do not fall below what they should have in the end.
  const std::vector<CellSize> narrow{{60'000, 0, 9000, 3000, 6000}, {60'000, 0, 9000, 3000, 6000}};
  EXPECT_NEAR(static_cast<double>(sum(cellTargets(narrow, 12'000))), 2 * (20'000 + 4000 * 0.85), 3);
}

}  // namespace
}  // namespace tet4d::qslim4d
