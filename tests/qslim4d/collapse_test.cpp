// Judged collapses against the link test of topology, which knows nothing of edges that are about to go.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "libpreprocess/error.h"
#include "libpreprocess/qslim4d/collapse.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::qslim4d {
namespace {

using hypermesh::Tet;
using Random = std::mt19937;

// The boundary of a 4-simplex: the smallest closed 3-manifold.
SlimMesh simplexBoundary(std::vector<Vec4f> points = {
                             {0, 0, 0, 0}, {1, 0, 0, 0.3F}, {0, 1, 0, 0.6F}, {0, 0, 1, 0.9F}, {1, 1, 1, 1.2F}}) {
  std::vector<Tet> tets;
  for (std::uint32_t skip = 0; skip < 5; ++skip) {
    Tet tet{};
    std::size_t n = 0;
    for (std::uint32_t v = 0; v < 5; ++v)
      if (v != skip) tet[n++] = v;
    if (skip % 2 != 0) std::swap(tet[0], tet[1]);
    tets.push_back(tet);
  }
  return makeSlimMesh(std::move(points), tets, {{-9, -9, -9, -9}, {9, 9, 9, 9}}, {}, Metric::kSlice);
}

// A block of n^3 cubes in space, each of six tetrahedra, lifted into time by a bump: an open 3-manifold whose walls are
// the block's, as a graph over space.
SlimMesh block(std::uint32_t n, bool walls = true) {
  const auto number = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (z * (n + 1) + y) * (n + 1) + x;
  };
  std::vector<Vec4f> points;
  for (std::uint32_t z = 0; z <= n; ++z)
    for (std::uint32_t y = 0; y <= n; ++y)
      for (std::uint32_t x = 0; x <= n; ++x) {
        const auto f = [](std::uint32_t i) { return static_cast<float>(i); };
        points.push_back({f(x), f(y), f(z), 0.7F * f(x) + 0.2F * f(y) + 0.1F * f(z) + 0.05F * f(x) * f(x)});
      }
  static constexpr std::uint32_t kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<Tet> tets;
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x)
        for (const auto& order : kOrders) {
          std::uint32_t at[3] = {x, y, z};
          Tet tet{number(x, y, z), 0, 0, 0};
          for (std::size_t k = 0; k < 3; ++k) {
            ++at[order[k]];
            tet[k + 1] = number(at[0], at[1], at[2]);
          }
          tets.push_back(tet);
        }
  const auto last = static_cast<float>(n);
  const float margin = walls ? 0 : 1;  // without walls the boundary is free
  return makeSlimMesh(points, tets,
                      {{-margin, -margin, -margin, -1}, {last + margin, last + margin, last + margin, 1000}}, {},
                      Metric::kSlice);
}

std::vector<Tet> liveTets(const SlimMesh& mesh) {
  std::vector<Tet> tets;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    if (mesh.isLive(t)) tets.push_back(mesh.tets[t]);
  return tets;
}

bool isManifold(const SlimMesh& mesh) { return topology::checkLinks(liveTets(mesh), mesh.positions.size(), true).ok(); }

TEST(Collapse, TheBoundaryOfASimplexCannotShrink) {
  SlimMesh mesh = simplexBoundary();
  ASSERT_TRUE(isManifold(mesh));
  Collapser collapser(mesh, {});
  for (std::uint32_t u = 0; u < 5; ++u)
    for (std::uint32_t v = u + 1; v < 5; ++v) {
      Placement placement;
      ASSERT_TRUE(collapser.evaluate(u, v, placement));
      EXPECT_NE(collapser.judge(u, v, placement.at), Verdict::kAllowed);
    }
}

// White noise: specks, handles, sheets that nearly touch. Collapses at random; whatever is allowed leaves a manifold,
// and without the link condition some of what it refuses would not.
TEST(Collapse, LinkConditionIsWhatKeepsAManifold) {
  namespace marching = hypermesh::testing;
  Random noise(11);
  marching::MemoryFrames<float> frames(
      {7, 7, 7}, 5, [&](auto, auto, auto, auto) { return static_cast<float>(noise() % 1000) / 1000 - 0.5F; });
  const marching::ExtractedMesh extracted = marching::extract(frames, {});
  SlimMesh mesh = makeSlimMesh(extracted.vertices, extracted.tets, extracted.header.domain, {}, Metric::kSlice);
  ASSERT_TRUE(isManifold(mesh));
  Random random(7);
  std::uint64_t allowed = 0, would_tear = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto u = static_cast<std::uint32_t>(random() % mesh.positions.size());
    if (!mesh.isUsed(u)) continue;
    Collapser collapser(mesh, {10, true, 1000});
    const auto around = collapser.neighbours(u);
    const std::uint32_t w = around[random() % around.size()], a = std::min(u, w), b = std::max(u, w);
    Placement placement;
    if (!collapser.evaluate(a, b, placement)) continue;
    const Verdict verdict = collapser.judge(a, b, placement.at);
    if (verdict == Verdict::kAllowed) {
      collapser.collapse(a, b, placement.at);
      if (++allowed % 50 == 0) {
        ASSERT_TRUE(isManifold(mesh)) << allowed;
      }
    } else if (verdict == Verdict::kLinks && would_tear < 5) {
      // Not each one does harm: a corner of one tetrahedron may vanish whole. The condition knows no such luck.
      SlimMesh torn = mesh;
      Collapser(torn, {}).collapse(a, b, placement.at);
      would_tear += isManifold(torn) ? 0 : 1;
    }
  }
  EXPECT_TRUE(isManifold(mesh));
  EXPECT_GT(allowed, 300u);
  EXPECT_EQ(would_tear, 5u);
}

TEST(Collapse, WallsAreKeptAndStarsAreLists) {
  SlimMesh mesh = block(4);
  Collapser collapser(mesh, {});
  Random random(3);
  std::uint64_t live = mesh.live_tets;
  for (int i = 0; i < 2000; ++i) {
    const auto u = static_cast<std::uint32_t>(random() % mesh.positions.size());
    if (!mesh.isUsed(u)) continue;
    const auto around = collapser.neighbours(u);
    const std::uint32_t w = around[random() % around.size()], a = std::min(u, w), b = std::max(u, w);
    Placement placement;
    const Walls before = mesh.walls[a] | mesh.walls[b];
    if (!collapser.evaluate(a, b, placement)) {
      EXPECT_TRUE(mesh.walls[a] != before && mesh.walls[b] != before);
      continue;
    }
    if (collapser.judge(a, b, placement.at) != Verdict::kAllowed) continue;
    live -= collapser.collapse(a, b, placement.at);
    EXPECT_EQ(mesh.walls[a], before);
    const Vec4f& p = mesh.positions[a];
    EXPECT_TRUE((before & 1) == 0 || p.x == 0);
    EXPECT_TRUE((before & 2) == 0 || p.x == 4);
    EXPECT_TRUE((before & 4) == 0 || p.y == 0);
    EXPECT_TRUE((before & 32) == 0 || p.z == 4);
  }
  EXPECT_EQ(liveTets(mesh).size(), live);
  EXPECT_LT(live, 300u) << "most of 384 tetrahedra can go";
  // Every living corner is in its vertex's list, once.
  std::uint64_t corners = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    mesh.forEachTet(v, [&](std::uint32_t tet, std::uint32_t corner) {
      EXPECT_EQ(mesh.tets[tet][corner], v);
      ++corners;
    });
  EXPECT_EQ(corners, 4 * live);
}

TEST(CollapseStiff, NonManifoldInputIsRefusedByName) {
  std::vector<Vec4f> points{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 1}, {0, 0, -1, 2}, {1, 1, 1, 3}};
  try {
    makeSlimMesh(points, {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}}, {{-9, -9, -9, -9}, {9, 9, 9, 9}}, {},
                 Metric::kSlice);
    FAIL() << "three tetrahedra at one triangle";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kBadInput);
    EXPECT_EQ(error.fault().place, "triangle 0 1 2");
  }
}

TEST(CollapseStiff, OneTetrahedronAndOneWithoutVolumeAreLeftAlone) {
  for (const float z : {1.0F, 0.0F}) {
    SlimMesh mesh = makeSlimMesh({{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 1}, {0, 0, z, 0}}, {{0, 1, 2, 3}},
                                 {{-9, -9, -9, -9}, {9, 9, 9, 9}}, {}, Metric::kSlice);
    Collapser collapser(mesh, {});
    Placement placement;
    ASSERT_TRUE(collapser.evaluate(0, 1, placement));
    EXPECT_NE(collapser.judge(0, 1, placement.at), Verdict::kAllowed);
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
