// The tetrahedra between lifelines that are kept at any frames: one by one against what defines them.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "libpreprocess/prisms/staircase.h"
#include "libpreprocess/topology/links.h"
#include "tests/prisms/moving_surfaces.h"

namespace tet4d::testing {
namespace {

using prisms::Kept;
using Place = std::pair<std::uint32_t, unsigned>;  // vertex, frame

constexpr unsigned kSteps = 7;

std::vector<Kept> randomKept(std::size_t vertices, double density, std::mt19937& random) {
  std::bernoulli_distribution keep(density);
  std::vector<Kept> kept(vertices, Kept{1} | Kept{1} << kSteps);
  for (Kept& k : kept) {
    for (unsigned f = 1; f < kSteps; ++f)
      if (keep(random)) k |= Kept{1} << f;
  }
  return kept;
}

// All tetrahedra, by the frames of their earliest vertices as pages are.
std::vector<std::array<Place, 4>> tetsOf(const Triangles& triangles, const std::vector<Kept>& kept) {
  std::vector<std::array<Place, 4>> tets;
  for (unsigned f = 0; f < kSteps; ++f) {
    for (const auto& t : triangles) {
      prisms::forEachTetAt(
          t, {kept[t[0]], kept[t[1]], kept[t[2]]}, f, [&](const auto& front, unsigned corner, unsigned to) {
            EXPECT_EQ(std::min({front[0], front[1], front[2]}), f);
            tets.push_back({Place{t[0], front[0]}, {t[1], front[1]}, {t[2], front[2]}, {t[corner], to}});
          });
    }
  }
  return tets;
}

class RandomLifelines : public ::testing::TestWithParam<int> {};

TEST_P(RandomLifelines, FillTheirColumnsAndAgreeAtEveryWall) {
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  const Triangles triangles = torusTriangles(5, 4);
  const std::vector<Kept> kept = randomKept(20, 0.1 * (GetParam() % 10), random);
  const auto tets = tetsOf(triangles, kept);
  // As many as the three lifelines have pieces.
  std::size_t expected = 0;
  for (const auto& t : triangles)
    for (const std::uint32_t v : t) expected += static_cast<std::size_t>(std::popcount(kept[v])) - 1;
  EXPECT_EQ(tets.size(), expected);
  // A closed 3-manifold but for the first and last frame, by its links.
  std::map<Place, std::uint32_t> number;
  std::vector<std::uint8_t> may_bound;
  std::vector<hypermesh::Tet> mesh;
  for (const auto& tet : tets) {
    hypermesh::Tet named{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [found, is_new] = number.try_emplace(tet[i], static_cast<std::uint32_t>(number.size()));
      if (is_new) may_bound.push_back(tet[i].second == 0 || tet[i].second == kSteps);
      named[i] = found->second;
    }
    mesh.push_back(named);
  }
  std::size_t places = 0;
  for (const Kept k : kept) places += static_cast<std::size_t>(std::popcount(k));
  EXPECT_EQ(number.size(), places) << "every kept vertex is used";
  const auto links = topology::checkLinks(mesh, may_bound);
  EXPECT_TRUE(links.ok()) << links.faults.front();
  EXPECT_EQ(links.disc_links, 40u);
}

TEST_P(RandomLifelines, DiagonalsAreTheTetrahedrasEdges) {
  std::mt19937 random(static_cast<unsigned>(GetParam()) + 1000);
  const Triangles triangles = torusTriangles(4, 4);
  const std::vector<Kept> kept = randomKept(16, 0.1 * (GetParam() % 10), random);
  std::set<std::pair<Place, Place>> from_tets, from_walls;
  for (const auto& tet : tetsOf(triangles, kept)) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j)
        if (tet[i].first != tet[j].first && tet[i].second < tet[j].second) from_tets.insert({tet[i], tet[j]});
    }
  }
  for (const auto& [low, high] : prisms::surfaceEdges(triangles).edges) {
    prisms::forEachDiagonal(kept[low], kept[high], [&, a = low, b = high](unsigned l, unsigned h, bool low_first) {
      ASSERT_LT(l, h);
      from_walls.insert({Place{low_first ? a : b, l}, Place{low_first ? b : a, h}});
    });
  }
  EXPECT_EQ(from_tets, from_walls);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomLifelines, ::testing::Range(0, 30));

TEST(Staircase, WithAllFramesKeptIsThePapersPrism) {
  const std::array<Kept, 3> kept{3, 3, 3};
  std::vector<std::array<Place, 4>> tets;
  const prisms::Triangle triangle{7, 2, 5};
  prisms::forEachTetAt(triangle, kept, 0, [&](const auto& front, unsigned corner, unsigned to) {
    tets.push_back({Place{7, front[0]}, {2, front[1]}, {5, front[2]}, {triangle[corner], to}});
  });
  // 7, 5, 2 go up in this order: the smaller vertex is at the bottom of every diagonal.
  const std::vector<std::array<Place, 4>> expected{{Place{7, 0}, {2, 0}, {5, 0}, {7, 1}},
                                                   {Place{7, 1}, {2, 0}, {5, 0}, {5, 1}},
                                                   {Place{7, 1}, {2, 0}, {5, 1}, {2, 1}}};
  EXPECT_EQ(tets, expected);
}

}  // namespace
}  // namespace tet4d::testing
