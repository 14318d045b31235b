// The CPU slicer against closed forms, brute force and topology.
#include "formats/core/slicer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "tests/exchange/support.h"

namespace tet4d {
namespace {

using testing::areaOf;
using testing::cubesBoundary;
using testing::isClosed;
using testing::randomCells;
using testing::repeatedTriangles;
using testing::SpaceTime;
using testing::volumeOf;

constexpr float kNoLastTime = std::numeric_limits<float>::infinity();

SliceMesh sliceOf(const SpaceTime& mesh, float t, float last_t = kNoLastTime) {
  SliceMesh slice;
  sliceTets(mesh.tets, mesh.vertices, {}, t, last_t, slice);
  return slice;
}

// Area of the slice of one tetrahedron, without any of the slicer's tables: the crossings of all six edges, ordered
// around their middle, as a polygon.
double bruteForceArea(const std::array<Vec4f, 4>& tet, double t) {
  std::vector<std::array<double, 3>> points;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const Vec4f &a = tet[i], &b = tet[j];
      if ((a.t < t) == (b.t < t)) continue;
      const double s = (t - a.t) / (double{b.t} - a.t);
      points.push_back({a.x + s * (double{b.x} - a.x), a.y + s * (double{b.y} - a.y), a.z + s * (double{b.z} - a.z)});
    }
  }
  if (points.size() < 3) return 0;
  const auto minus = [](const std::array<double, 3>& p, const std::array<double, 3>& q) {
    return std::array<double, 3>{p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  };
  const auto cross = [](const std::array<double, 3>& u, const std::array<double, 3>& v) {
    return std::array<double, 3>{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  };
  const auto dot = [](const std::array<double, 3>& u, const std::array<double, 3>& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  };
  std::array<double, 3> middle{0, 0, 0};
  for (const auto& p : points) {
    for (std::size_t c = 0; c < 3; ++c) middle[c] += p[c] / static_cast<double>(points.size());
  }
  const auto normal = cross(minus(points[0], middle), minus(points[1], middle));
  const auto axis = minus(points[0], middle), other = cross(normal, axis);
  const double other_scale = std::sqrt(dot(axis, axis) / dot(other, other));
  std::sort(points.begin(), points.end(), [&](const auto& p, const auto& q) {
    const auto angle = [&](const auto& r) {
      return std::atan2(dot(minus(r, middle), other) * other_scale, dot(minus(r, middle), axis));
    };
    return angle(p) < angle(q);
  });
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto n = cross(minus(points[i], middle), minus(points[(i + 1) % points.size()], middle));
    area += std::sqrt(dot(n, n)) / 2;
  }
  return area;
}

TEST(Slicer, TriangleOfOneTetrahedronIsExact) {
  const SpaceTime mesh{{{0, 0, 0, 0}, {1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}, {{0, 1, 2, 3}}};
  const SliceMesh slice = sliceOf(mesh, 0.25f);
  ASSERT_EQ(slice.triangles.size(), 1u);
  ASSERT_EQ(slice.positions.size(), 3u);
  EXPECT_EQ(slice.keys[0], (SliceVertexKey{0, 1}));
  EXPECT_EQ(slice.positions[0], (Vec3f{0.25f, 0, 0}));
  EXPECT_EQ(slice.positions[2], (Vec3f{0, 0, 0.25f}));
  EXPECT_NEAR(areaOf(slice), std::sqrt(3.0) / 2 * 0.0625, 1e-9);
}

TEST(Slicer, QuadrilateralIsTwoTrianglesWoundAlike) {
  // Two vertices at time 0, two at time 1: the middle slice is the unit-half square.
  const SpaceTime mesh{{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 1}, {0, 1, 1, 1}}, {{0, 1, 2, 3}}};
  const SliceMesh slice = sliceOf(mesh, 0.5f);
  ASSERT_EQ(slice.triangles.size(), 2u);
  EXPECT_EQ(slice.positions.size(), 4u);
  EXPECT_NEAR(areaOf(slice), 0.25, 1e-7);
  // Wound alike: the shared diagonal is used once each way.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> used;
  for (const auto& t : slice.triangles) {
    for (std::size_t c = 0; c < 3; ++c) ++used[{t[c], t[(c + 1) % 3]}];
  }
  EXPECT_EQ(used.size(), 6u);
}

TEST(Slicer, WindingFollowsThePositiveTetrahedron) {
  // Positive for the normal +z: det(z, b - a, c - a, d - a) = 1 (see tet_slice.h).
  const std::vector<Vec4f> vertices{{0, 0, 0, 0}, {0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}};
  std::array<std::uint32_t, 4> order{0, 1, 2, 3};
  int permutations = 0;
  do {
    int inversions = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) inversions += order[i] > order[j];
    }
    const SliceMesh slice = sliceOf({vertices, {order}}, 0.5f);
    ASSERT_EQ(slice.triangles.size(), 1u);
    const auto& t = slice.triangles[0];
    const Vec3f &p = slice.positions[t[0]], &q = slice.positions[t[1]], &r = slice.positions[t[2]];
    const float z = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    EXPECT_EQ(z > 0, inversions % 2 == 0);
    ++permutations;
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(permutations, 24);
}

TEST(Slicer, RandomTetrahedraHaveTheAreaOfBruteForce) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-2, 2);
  int quadrilaterals = 0;
  for (int round = 0; round < 2000; ++round) {
    std::array<Vec4f, 4> tet;
    for (Vec4f& v : tet) v = {place(random), place(random), place(random), place(random)};
    const float t = place(random);
    const SliceMesh slice = sliceOf({{tet.begin(), tet.end()}, {{0, 1, 2, 3}}}, t);
    const double expected = bruteForceArea(tet, t);
    ASSERT_NEAR(areaOf(slice), expected, 1e-4 * (1 + expected)) << "round " << round;
    quadrilaterals += slice.triangles.size() == 2;
  }
  EXPECT_GT(quadrilaterals, 100);
}

// Volume of the slice of a 4-simplex: its 4-volume times the B-spline on its times (Curry and Schoenberg).
double splineVolume(const std::array<Vec4f, 5>& simplex, double volume4, double t) {
  double sum = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    double product = 1;
    for (std::size_t j = 0; j < 5; ++j) {
      if (j != i) product *= double{simplex[i].t} - simplex[j].t;
    }
    sum += std::pow(std::max(0.0, simplex[i].t - t), 3) / product;
  }
  return 4 * volume4 * sum;
}

TEST(Slicer, SimplexSlicesEncloseTheirBSplineVolume) {
  const auto cells = cubesBoundary(1, {true});
  // The Kuhn cube's slices have volume 1; sheared in time, they have that of a box between two slanted walls.
  SpaceTime sheared = cells;
  for (Vec4f& v : sheared.vertices) v.t += 0.5f * v.x;
  for (const float t : {0.125f, 0.25f, 0.75f, 1.0f, 1.25f}) {
    const double expected = t < 0.5f ? 2 * t : t > 1 ? 2 * (1.5 - t) : 1.0;
    const SliceMesh slice = sliceOf(sheared, t);
    EXPECT_TRUE(isClosed(slice)) << t;
    EXPECT_NEAR(volumeOf(slice), expected, 1e-6) << t;
  }
  // A corner simplex x, y, z, t >= 0 with sides 1, 2, 3 and apex times spread out: 4-volume = det / 24.
  const std::array<Vec4f, 5> simplex{
      {{0, 0, 0, 0}, {1, 0, 0, 0.25f}, {0, 2, 0, 0.5f}, {0, 0, 3, 0.75f}, {0.2f, 0.3f, 0.1f, 2}}};
  // det of the edge vectors, expanded along the last: t-part of v4 less what its x, y, z parts reach.
  const double volume4 = 6 * (2 - (0.2 * 0.25 + 0.3 / 2 * 0.5 + 0.1 / 3 * 0.75)) / 24;
  SpaceTime mesh{{simplex.begin(), simplex.end()}, {}};
  for (std::uint32_t left_out = 0; left_out < 5; ++left_out) {
    hypermesh::Tet tet{};
    for (std::uint32_t k = 0, at = 0; k < 5; ++k) {
      if (k != left_out) tet[at++] = k;
    }
    if (left_out % 2 != 0) std::swap(tet[2], tet[3]);  // the boundary operator's sign
    mesh.tets.push_back(tet);
  }
  const double sign = volumeOf(sliceOf(mesh, 0.6f)) > 0 ? 1 : -1;
  for (const float t : {0.1f, 0.25f, 0.4f, 0.5f, 0.6f, 0.75f, 1.0f, 1.9f}) {
    const SliceMesh slice = sliceOf(mesh, t);
    EXPECT_TRUE(isClosed(slice)) << t;
    EXPECT_NEAR(sign * volumeOf(slice), splineVolume(simplex, volume4, t), 2e-6) << t;
  }
}

TEST(Slicer, CubesAreClosedWithTheirVolumeAtAnyTime) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const auto filled = randomCells(2, 0.5, seed);
    const SpaceTime mesh = cubesBoundary(2, filled);
    for (const float t : {0.0f, 0.3f, 1.0f, 1.75f, 2.0f}) {
      const std::size_t slab = t < 1 ? 0 : 1;  // at t = 2 the last slab is still alive
      const double cells =
          static_cast<double>(std::count(filled.begin() + static_cast<std::ptrdiff_t>(8 * slab),
                                         filled.begin() + static_cast<std::ptrdiff_t>(8 * slab + 8), true));
      const SliceMesh slice = sliceOf(mesh, t, 2.0f);
      EXPECT_TRUE(isClosed(slice)) << "seed " << seed << " t " << t;
      EXPECT_NEAR(volumeOf(slice), cells, 1e-5) << "seed " << seed << " t " << t;
      EXPECT_EQ(repeatedTriangles(slice), 0u) << "seed " << seed << " t " << t;
    }
    EXPECT_TRUE(sliceOf(mesh, 2.0f).triangles.empty()) << "open at the end, unless it is the last time";
    EXPECT_TRUE(sliceOf(mesh, 2.5f, 2.0f).triangles.empty());
    EXPECT_TRUE(sliceOf(mesh, -0.5f, 2.0f).triangles.empty());
  }
}

TEST(Slicer, FrameSlicesUseVerticesNotEdges) {
  const SpaceTime mesh = cubesBoundary(2, randomCells(2, 0.5, 3));
  for (const float t : {0.0f, 1.0f, 2.0f}) {
    const SliceMesh slice = sliceOf(mesh, t, 2.0f);
    ASSERT_FALSE(slice.keys.empty());
    for (std::size_t i = 0; i < slice.keys.size(); ++i) {
      ASSERT_EQ(slice.keys[i].a, slice.keys[i].b);
      const Vec4f& vertex = mesh.vertices[slice.keys[i].a];
      ASSERT_EQ(slice.positions[i], (Vec3f{vertex.x, vertex.y, vertex.z}));
      ASSERT_EQ(vertex.t, t);
    }
  }
}

TEST(Slicer, StaysClosedWhenTimesTieAtRandom) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SpaceTime mesh = cubesBoundary(2, randomCells(2, 0.4, seed));
    std::mt19937 random(seed);
    for (Vec4f& v : mesh.vertices) {
      v.t = static_cast<float>(random() % 5);
      v.x += static_cast<float>(random() % 8) / 32;
    }
    for (const float t : {0.0f, 0.5f, 1.0f, 2.0f, 2.5f, 3.0f, 4.0f}) {
      const SliceMesh slice = sliceOf(mesh, t, 4.0f);
      EXPECT_TRUE(isClosed(slice)) << "seed " << seed << " t " << t;
      for (const auto& triangle : slice.triangles) {
        ASSERT_TRUE(triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0]);
      }
    }
  }
}

TEST(Slicer, OrderIsThatOfFirstUseAndIdsNameTheKeys) {
  const SpaceTime mesh = cubesBoundary(2, randomCells(2, 0.5, 5));
  std::vector<std::uint64_t> ids(mesh.vertices.size());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = 0xfffffffffffff000ull - 977 * i;
  const SliceMesh plain = sliceOf(mesh, 0.4f);
  SliceMesh named;
  sliceTets(mesh.tets, mesh.vertices, ids, 0.4f, kNoLastTime, named);
  EXPECT_EQ(plain.triangles, named.triangles) << "numbers do not depend on the keys";
  EXPECT_EQ(plain.positions, named.positions);
  std::uint32_t next = 0;
  for (const auto& triangle : plain.triangles) {
    for (std::uint32_t corner : {triangle[0], triangle[1], triangle[2]}) {
      ASSERT_LE(corner, next + 2);
      next = std::max(next, corner + 1);
    }
  }
  EXPECT_EQ(next, plain.positions.size()) << "every vertex is used";
  for (std::size_t i = 0; i < plain.keys.size(); ++i) {
    ASSERT_EQ(named.keys[i], (SliceVertexKey{ids[plain.keys[i].a], ids[plain.keys[i].b]}));
  }
}

TEST(Slicer, AppendsToWhatIsThere) {
  const SpaceTime mesh = cubesBoundary(1, {true});
  SliceMesh twice = sliceOf(mesh, 0.5f);
  const std::size_t vertices = twice.positions.size(), triangles = twice.triangles.size();
  sliceTets(mesh.tets, mesh.vertices, {}, 0.5f, kNoLastTime, twice);
  EXPECT_EQ(twice.positions.size(), 2 * vertices);
  EXPECT_EQ(twice.triangles.size(), 2 * triangles);
  EXPECT_TRUE(isClosed(twice));
  EXPECT_NEAR(volumeOf(twice), 2.0, 1e-6);
}

TEST(Slicer, NormalsAreUnitAndPointOutward) {
  const SliceMesh slice = sliceOf(cubesBoundary(1, {true}), 0.5f);
  const auto normals = sliceNormals(slice);
  ASSERT_EQ(normals.size(), slice.positions.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3f& n = normals[i];
    const Vec3f& p = slice.positions[i];
    EXPECT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-6);
    EXPECT_GT(n.x * (p.x - 0.5f) + n.y * (p.y - 0.5f) + n.z * (p.z - 0.5f), 0);
  }
}

TEST(Slicer, NormalsWeighByAreaAndAreZeroWithoutArea) {
  // At the corner: one triangle of area 2 facing z, one of area 0.5 facing x.
  SliceMesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 1, 0}, {0, 0, 1}, {5, 5, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {5, 5, 5}};
  const auto normals = sliceNormals(mesh);
  EXPECT_NEAR(normals[0].z / normals[0].x, 4, 1e-5);
  EXPECT_EQ(normals[5], (Vec3f{0, 0, 0}));
}

}  // namespace
}  // namespace tet4d
