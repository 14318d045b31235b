// Dynamic triangles against brute-force slices of the same tetrahedra.
#include "libpreprocess/dyntri/dynamic_triangles_builder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "formats/core/slicer.h"

namespace tet4d::dyntri {
namespace {

using hypermesh::Tet;
using D3 = std::array<double, 3>;

D3 cross(const D3& u, const D3& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}
D3 minus(const Vec3f& a, const Vec3f& b) {
  return {double{a.x} - double{b.x}, double{a.y} - double{b.y}, double{a.z} - double{b.z}};
}

// Vector area (half the sum of cross products) of the triangles alive at t: sensitive to winding, doubles and gaps.
D3 vectorArea(const BuiltPage& page, float t, float last_t, std::size_t* alive = nullptr) {
  D3 sum{};
  for (std::size_t i = 0; i < page.triangles.size(); ++i) {
    if (!isAlive(page.lifespans[i].begin, page.lifespans[i].end, t, last_t)) continue;
    if (alive != nullptr) ++*alive;
    std::array<Vec3f, 3> p;
    for (std::size_t c = 0; c < 3; ++c) {
      const Edge& e = page.edges[page.triangles[i][c]];
      p[c] = interpolateAt(page.vertices[e.a], page.vertices[e.b], t);
    }
    const D3 n = cross(minus(p[1], p[0]), minus(p[2], p[0]));
    for (std::size_t k = 0; k < 3; ++k) sum[k] += 0.5 * n[k];
  }
  return sum;
}

// The slice of one tetrahedron by brute force, without the tables: all edges crossed at t give the corners of a convex
// polygon in a plane; its area is summed by angle, and its normal is the spatial part of the 4D normal.
D3 bruteVectorArea(const std::array<Vec4f, 4>& v, double t) {
  std::vector<D3> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double a = v[i].t, b = v[j].t;
      if ((a < t) == (b < t)) continue;
      const double s = (t - a) / (b - a);
      corners.push_back({v[i].x + s * (double{v[j].x} - v[i].x), v[i].y + s * (double{v[j].y} - v[i].y),
                         v[i].z + s * (double{v[j].z} - v[i].z)});
    }
  }
  if (corners.size() < 3) return {};
  // det(n, d1, d2, d3) expanded by n: the spatial part of the outward normal.
  std::array<std::array<double, 4>, 3> d{};
  for (std::size_t i = 0; i < 3; ++i) {
    d[i] = {double{v[i + 1].x} - v[0].x, double{v[i + 1].y} - v[0].y, double{v[i + 1].z} - v[0].z,
            double{v[i + 1].t} - v[0].t};
  }
  const auto minor = [&](std::size_t p, std::size_t q, std::size_t r) {
    return d[0][p] * (d[1][q] * d[2][r] - d[1][r] * d[2][q]) - d[0][q] * (d[1][p] * d[2][r] - d[1][r] * d[2][p]) +
           d[0][r] * (d[1][p] * d[2][q] - d[1][q] * d[2][p]);
  };
  const D3 normal{minor(1, 2, 3), -minor(0, 2, 3), minor(0, 1, 3)};
  D3 centre{};
  for (const D3& c : corners) {
    for (std::size_t k = 0; k < 3; ++k) centre[k] += c[k] / static_cast<double>(corners.size());
  }
  const auto relative = [&](const D3& c) { return D3{c[0] - centre[0], c[1] - centre[1], c[2] - centre[2]}; };
  const D3 axis = relative(corners[0]);
  const D3 other = cross(normal, axis);
  const auto angle = [&](const D3& c) {
    const D3 r = relative(c);
    const double scale = std::hypot(normal[0], normal[1], normal[2]);
    return std::atan2((r[0] * other[0] + r[1] * other[1] + r[2] * other[2]) / scale,
                      r[0] * axis[0] + r[1] * axis[1] + r[2] * axis[2]);
  };
  std::sort(corners.begin(), corners.end(), [&](const D3& a, const D3& b) { return angle(a) < angle(b); });
  D3 sum{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const D3 n = cross(relative(corners[i]), relative(corners[(i + 1) % corners.size()]));
    for (std::size_t k = 0; k < 3; ++k) sum[k] += 0.5 * n[k];
  }
  return sum;
}

TEST(DynamicTriangles, RandomTetsMatchBruteForceAtEveryTime) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int round = 0; round < 400; ++round) {
    std::array<Vec4f, 4> v;
    for (Vec4f& p : v) p = {unit(random), unit(random), unit(random), unit(random)};
    if (round % 4 == 1) v[2].t = v[0].t;
    if (round % 4 == 2) v[1].t = v[2].t = v[3].t;
    if (round % 4 == 3) v[0].t = v[1].t, v[2].t = v[3].t;
    const Tet tet{0, 1, 2, 3};
    const BuiltPage page = buildPage({&tet, 1}, v);
    for (int k = 0; k < 9; ++k) {
      const float t = unit(random);
      const D3 ours = vectorArea(page, t, 100), brute = bruteVectorArea(v, t);
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(ours[c], brute[c], 2e-5) << "round " << round << " t " << t;
    }
  }
}

TEST(DynamicTriangles, EdgesAndLifespansHoldTheirPromises) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> step(0, 3);  // many equal times
  std::vector<Vec4f> positions(60);
  for (Vec4f& p : positions) {
    p = {static_cast<float>(step(random)), static_cast<float>(step(random)), static_cast<float>(step(random)),
         static_cast<float>(step(random))};
  }
  std::uniform_int_distribution<std::uint32_t> pick(0, 59);
  std::vector<Tet> tets(500);
  for (Tet& tet : tets) tet = {pick(random), pick(random), pick(random), pick(random)};
  const BuiltPage page = buildPage(tets, positions);
  EXPECT_EQ(page.tets, tets.size());
  EXPECT_EQ(page.triangles.size() + page.empty, 4 * tets.size());
  EXPECT_GT(page.empty, tets.size());  // equal times leave triangles out
  std::set<std::pair<std::uint32_t, std::uint32_t>> unique;
  for (const Edge& e : page.edges) {
    EXPECT_LT(page.vertices[e.a].t, page.vertices[e.b].t);
    EXPECT_TRUE(unique.insert({e.a, e.b}).second);
  }
  for (std::size_t i = 0; i < page.triangles.size(); ++i) {
    float begin = -1, end = 100;
    for (const std::uint32_t e : page.triangles[i]) {
      begin = std::max(begin, page.vertices[page.edges[e].a].t);
      end = std::min(end, page.vertices[page.edges[e].b].t);
    }
    EXPECT_EQ(page.lifespans[i].begin, begin);
    EXPECT_EQ(page.lifespans[i].end, end);
    EXPECT_LT(begin, end);
  }
}

// A hub with more edges than a chain holds: every edge is still one edge.
TEST(DynamicTriangles, AHubOfManyEdgesNumbersEachOnce) {
  constexpr std::uint32_t kRim = 400;
  std::vector<Vec4f> positions{{0, 0, 0, 0}};
  for (std::uint32_t i = 0; i < kRim; ++i)
    positions.push_back({static_cast<float>(i), static_cast<float>(i * i % 97), 1, 1 + static_cast<float>(i % 5)});
  std::vector<Tet> tets;
  for (std::uint32_t i = 1; i + 2 <= kRim; ++i) tets.push_back({0, i, i + 1, i + 2});
  const BuiltPage page = buildPage(tets, positions);
  std::set<std::pair<std::uint32_t, std::uint32_t>> unique;
  std::size_t from_hub = 0;
  for (const Edge& e : page.edges) {
    EXPECT_TRUE(unique.insert({e.a, e.b}).second);
    if (page.vertices[e.a].t == 0) ++from_hub;
  }
  EXPECT_EQ(from_hub, kRim);
}

// A prism chain: one tetrahedron over [0, 1] and its mirror image over [1, 2] share the face at t = 1.
TEST(DynamicTriangles, FrameTimesDrawOnceAndTheLastTimeIsClosed) {
  const std::vector<Vec4f> positions{{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 0, 0}, {0, 0, 0, 2}};
  const std::vector<Tet> tets{{0, 1, 2, 3}, {0, 2, 1, 4}};
  const BuiltPage page = buildPage(tets, positions);
  std::size_t alive = 0;
  const D3 at_frame = vectorArea(page, 1, 2, &alive);
  EXPECT_EQ(alive, 1u);
  EXPECT_NEAR(std::abs(at_frame[2]), 0.5, 1e-6);
  alive = 0;
  vectorArea(page, 2, 2, &alive);
  EXPECT_EQ(alive, 1u);  // closed at the last time only
  alive = 0;
  vectorArea(page, 2, 3, &alive);
  EXPECT_EQ(alive, 0u);
}

TEST(DynamicTriangles, EmptyPageAndTetOfOneTime) {
  EXPECT_TRUE(buildPage({}, {}).triangles.empty());
  const std::vector<Vec4f> flat{{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
  const Tet tet{0, 1, 2, 3};
  const BuiltPage page = buildPage({&tet, 1}, flat);
  EXPECT_TRUE(page.triangles.empty() && page.edges.empty() && page.vertices.empty());
  EXPECT_EQ(page.empty, 4u);
}

// The CPU slicer works on tetrahedra, the page on edges: the same triangles must come out.
TEST(DynamicTriangles, AgreesWithTheSlicer) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Vec4f> positions(40);
  for (Vec4f& p : positions) p = {unit(random), unit(random), unit(random), unit(random)};
  std::uniform_int_distribution<std::uint32_t> pick(0, 39);
  std::vector<Tet> tets;
  while (tets.size() < 200) {
    const Tet tet{pick(random), pick(random), pick(random), pick(random)};
    if (std::set<std::uint32_t>(tet.begin(), tet.end()).size() == 4) tets.push_back(tet);
  }
  const BuiltPage page = buildPage(tets, positions);
  for (const float t : {0.1F, 0.5F, positions[7].t, 0.93F}) {
    SliceMesh slice;
    sliceTets(tets, positions, {}, t, 100, slice);
    D3 sum{};
    for (const auto& tri : slice.triangles) {
      const D3 n = cross(minus(slice.positions[tri[1]], slice.positions[tri[0]]),
                         minus(slice.positions[tri[2]], slice.positions[tri[0]]));
      for (std::size_t k = 0; k < 3; ++k) sum[k] += 0.5 * n[k];
    }
    const D3 ours = vectorArea(page, t, 100);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(ours[k], sum[k], 1e-4) << "t " << t;
  }
}

}  // namespace
}  // namespace tet4d::dyntri
