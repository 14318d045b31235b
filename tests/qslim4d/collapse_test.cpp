// Judged collapses against the link test of topology, which knows nothing of edges that are about to go.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "libpreprocess/error.h"
#include "libpreprocess/qslim4d/collapse.h"
#include "libpreprocess/topology/links.h"

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

// Every edge of a block with a free boundary: what is allowed leaves a manifold, what would not is among the refused.
TEST(Collapse, LinkConditionIsWhatKeepsAManifold) {
  std::uint64_t allowed = 0, refused = 0;
  const SlimMesh whole = block(3, false);
  ASSERT_TRUE(isManifold(whole));
  // A few collapses first, so that stars are of all kinds.
  Random random(7);
  SlimMesh start = whole;
  {
    CollapseRules rules;
    rules.most_star = 1000;
    Collapser collapser(start, rules);
    for (int i = 0; i < 12; ++i) {
      const auto u = static_cast<std::uint32_t>(random() % 64);
      if (start.head[u] == kNone) continue;
      const auto around = collapser.neighbours(u);
      const std::uint32_t v = around[random() % around.size()];
      Placement placement;
      if (!collapser.evaluate(std::min(u, v), std::max(u, v), placement)) continue;
      if (collapser.judge(std::min(u, v), std::max(u, v), placement.at) != Verdict::kAllowed) continue;
      collapser.collapse(std::min(u, v), std::max(u, v), placement.at);
      ASSERT_TRUE(isManifold(start));
    }
  }
  for (std::uint32_t u = 0; u < 64; ++u) {
    if (start.head[u] == kNone) continue;
    Collapser reader(start, {});
    const auto around = reader.neighbours(u);
    for (const std::uint32_t v : std::vector<std::uint32_t>(around.begin(), around.end())) {
      if (v < u) continue;
      SlimMesh mesh = start;
      Collapser collapser(mesh, {10, true, 1000});
      Placement placement;
      if (!collapser.evaluate(u, v, placement)) continue;
      const Verdict verdict = collapser.judge(u, v, placement.at);
      if (verdict != Verdict::kAllowed && verdict != Verdict::kLinks) continue;
      collapser.collapse(u, v, placement.at);
      // A collapse against the link condition may leave a manifold of another kind; of a ball that is no ball.
      const std::vector<Tet> tets = liveTets(mesh);
      const topology::LinkCheck check = topology::checkLinks(tets, mesh.positions.size(), true);
      if (verdict == Verdict::kAllowed) {
        EXPECT_TRUE(check.ok()) << u << " " << v;
        ++allowed;
      } else {
        // Not each one would do harm: a corner of one tetrahedron may vanish whole. The condition knows no such luck.
        refused += check.ok() ? 0 : 1;
      }
    }
  }
  EXPECT_GT(allowed, 10u);
  EXPECT_GT(refused, 5u) << "without the test these would have torn the mesh";
}

TEST(Collapse, WallsAreKeptAndStarsAreLists) {
  SlimMesh mesh = block(4);
  Collapser collapser(mesh, {});
  Random random(3);
  std::uint64_t live = mesh.live_tets;
  for (int i = 0; i < 2000; ++i) {
    const auto u = static_cast<std::uint32_t>(random() % mesh.positions.size());
    if (mesh.head[u] == kNone) continue;
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
