// Patches: every tetrahedron once, no patch too large, the same bits for a vertex in each.
#include "libpreprocess/vpartition/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

namespace tet4d::vpartition {
namespace {

using hypermesh::Tet;

TEST(CutPatches, EveryTetrahedronIsInOnePatchOfItsNode) {
  std::mt19937 random(2);
  for (const bool all_at_one_place : {false, true}) {
    constexpr std::uint32_t kCount = 5000;
    std::vector<Place> places(kCount, Place{3, 3, 3, 3});
    std::vector<std::uint32_t> left_by(kCount), order(kCount);
    std::iota(order.begin(), order.end(), 0U);
    for (std::uint32_t t = 0; t < kCount; ++t) {
      left_by[t] = static_cast<std::uint32_t>(random()) % 5;
      if (all_at_one_place) continue;
      for (std::int64_t& along : places[t]) along = static_cast<std::int64_t>(random() % 1000);
    }
    const std::vector<PatchRange> ranges = cutPatches(order, left_by, places, 300);
    std::uint32_t next = 0;
    for (const PatchRange& range : ranges) {
      EXPECT_EQ(range.begin, next);
      next = range.end;
      EXPECT_LE(range.end - range.begin, 300U);
      EXPECT_GE(range.end - range.begin, 100U) << "halves of what was too large";
      for (std::uint32_t i = range.begin; i < range.end; ++i) EXPECT_EQ(left_by[order[i]], range.lower);
    }
    EXPECT_EQ(next, kCount);
    EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), kCount);
  }
}

TEST(MakePatch, SharedVerticesComeFirstAndTetrahedraKeepTheirCorners) {
  const std::vector<Vec4f> positions{{0, 0, 0, 0}, {1, 0, 0, 1}, {0, 1, 0, 2},
                                     {0, 0, 1, 3}, {1, 1, 1, 4}, {-0.0f, 2, 2, 5}};
  const std::vector<Tet> tets{{0, 1, 2, 3}, {3, 2, 1, 4}, {1, 4, 5, 2}};
  std::vector<std::uint32_t> users(positions.size(), kUnused);
  noteUser(users, tets[0], 0), noteUser(users, tets[1], 0), noteUser(users, tets[2], 1);
  EXPECT_EQ(users, (std::vector<std::uint32_t>{0, kSeveral, kSeveral, 0, kSeveral, 1}));
  const std::vector<std::uint32_t> chosen{0, 1};
  const StoredPatch patch = makePatch(chosen, tets, positions, users);
  ASSERT_EQ(patch.vertices.size(), 5U);
  EXPECT_EQ(patch.shared, 3U);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(patch.vertices[patch.tets[t][i]], positions[tets[t][i]]);
  const std::vector<std::uint32_t> other{2};
  EXPECT_TRUE(std::signbit(makePatch(other, tets, positions, users).vertices.back().x)) << "to the bit";
}

// As many tetrahedra as a patch may have, none of which share a vertex: local indices still name them all.
TEST(MakePatch, TheLargestPatchHasRoom) {
  std::vector<Tet> tets(kMostPatchTets);
  std::vector<Vec4f> positions;
  for (Tet& tet : tets) {
    for (std::uint32_t& v : tet) {
      v = static_cast<std::uint32_t>(positions.size());
      positions.push_back({static_cast<float>(v), 0, 0, 0});
    }
  }
  std::vector<std::uint32_t> users(positions.size(), 0), chosen(tets.size());
  std::iota(chosen.begin(), chosen.end(), 0U);
  const StoredPatch patch = makePatch(chosen, tets, positions, users);
  EXPECT_LE(patch.vertices.size(), patch_dag::kMostVertices);
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i) ASSERT_EQ(patch.vertices[patch.tets[t][i]], positions[tets[t][i]]);
}

}  // namespace
}  // namespace tet4d::vpartition
