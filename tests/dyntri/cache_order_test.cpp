// The order of triangles in their buckets: what a cache of slice vertices saves, and that nothing else changes.
#include "libpreprocess/dyntri/cache_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "libpreprocess/dyntri/dynamic_triangles_builder.h"

namespace tet4d::dyntri {
namespace {

using hypermesh::Tet;

struct Mesh {
  std::vector<Vec4f> positions;
  std::vector<Tet> tets;
};

// A sheet of side x side squares that rises while the time goes from 0 to 1: prisms of three tetrahedra each.
Mesh sheet(std::uint32_t side) {
  Mesh mesh;
  const std::uint32_t row = side + 1, level = row * row;
  for (std::uint32_t k = 0; k < 2; ++k) {
    for (std::uint32_t i = 0; i < level; ++i)
      mesh.positions.push_back(
          {static_cast<float>(i % row), static_cast<float>(i / row), static_cast<float>(k), static_cast<float>(k)});
  }
  const auto prism = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.tets.push_back({a, b, c, a + level});
    mesh.tets.push_back({b, c, a + level, b + level});
    mesh.tets.push_back({c, a + level, b + level, c + level});
  };
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * row + x;
      prism(a, a + 1, a + row);
      prism(a + 1, a + row, a + row + 1);
    }
  }
  return mesh;
}

// Misses a triangle of a first-in-first-out cache.
double missesOf(std::span<const Triangle> triangles, std::size_t edges, std::size_t entries) {
  std::vector<std::size_t> since(edges, 0);
  std::size_t misses = 0;
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t e : triangle) {
      if (since[e] == 0 || misses - since[e] >= entries) since[e] = ++misses;
    }
  }
  return static_cast<double>(misses) / static_cast<double>(triangles.size());
}

std::vector<Triangle> inOrder(std::span<const Triangle> triangles, std::span<const std::uint32_t> order) {
  std::vector<Triangle> out;
  for (const std::uint32_t i : order) out.push_back(triangles[i]);
  return out;
}

// A plain grid: a vertex serves six triangles, so no order has less than half a miss a triangle.
std::vector<Triangle> grid(std::uint32_t side) {
  std::vector<Triangle> triangles;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x, b = a + side + 1;
      triangles.push_back({a, a + 1, b});
      triangles.push_back({a + 1, b + 1, b});
    }
  }
  return triangles;
}

TEST(CacheOrder, AGridInAnyOrderNeedsLittleMoreThanHalfAVertexATriangle) {
  constexpr std::uint32_t kSide = 70, kVertices = (kSide + 1) * (kSide + 1);
  std::vector<Triangle> triangles = grid(kSide);
  CacheOrder cache(kVertices, triangles.size());
  EXPECT_GT(missesOf(triangles, kVertices, kCacheEntries), 0.95) << "row by row, the row before has gone";
  EXPECT_LT(missesOf(inOrder(triangles, cache.order(triangles)), kVertices, kCacheEntries), 0.75);
  std::mt19937 random(3);
  std::shuffle(triangles.begin(), triangles.end(), random);
  EXPECT_GT(missesOf(triangles, kVertices, kCacheEntries), 2.9);
  EXPECT_LT(missesOf(inOrder(triangles, cache.order(triangles)), kVertices, kCacheEntries), 0.85);
}

TEST(CacheOrder, IsAPermutationThatDependsOnTheRunAlone) {
  std::vector<Triangle> triangles = grid(9);
  triangles.insert(triangles.end(), triangles.begin(), triangles.begin() + 20);  // the same edges again
  CacheOrder used(400, 300), fresh(1000, triangles.size());
  used.order(grid(12));
  const auto first = used.order(triangles);
  std::vector<Triangle> renumbered(triangles);
  for (Triangle& triangle : renumbered) {
    for (std::uint32_t& e : triangle) e = 999 - e;
  }
  const auto second = fresh.order(renumbered);
  ASSERT_TRUE(std::equal(first.begin(), first.end(), second.begin(), second.end()));
  std::vector<std::uint32_t> sorted(first.begin(), first.end()), all(triangles.size());
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(sorted, all);
  EXPECT_TRUE(used.order({}).empty());
}

// The whole page: shuffled tetrahedra come out about as well as those in rows, and it is the same surface.
TEST(CacheOrder, PagesAreOrderedHoweverTheirTetrahedraStand) {
  Mesh mesh = sheet(60);
  const BuiltPage in_rows = buildPage(mesh.tets, mesh.positions, 1);
  std::mt19937 random(3);
  std::shuffle(mesh.tets.begin(), mesh.tets.end(), random);
  const BuiltPage shuffled = buildPage(mesh.tets, mesh.positions, 1);
  const auto lives = [](const BuiltPage& page) {
    std::vector<std::pair<float, float>> all;
    for (const Lifespan& life : page.lifespans) all.emplace_back(life.begin, life.end);
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(lives(in_rows), lives(shuffled));
  EXPECT_EQ(in_rows.edges.size(), shuffled.edges.size());
  for (const BuiltPage* page : {&in_rows, &shuffled})
    EXPECT_LT(missesOf(page->triangles, page->edges.size(), kCacheEntries), 0.85);
}

}  // namespace
}  // namespace tet4d::dyntri
