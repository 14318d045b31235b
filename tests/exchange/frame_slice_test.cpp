// The standing test of slices: at a frame's time a hypermesh is the hull table's marching cubes of that frame, vertex
// for vertex; between frames it is closed but for the domain's walls. The three-dimensional hull is computed here, from
// the definition, with nothing of the table's making.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"
#include "tests/exchange/support.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d {
namespace {

using Frames = hypermesh::testing::MemoryFrames<float>;
using Point = std::array<int, 3>;  // doubled coordinates: corners even, midpoints of edges odd in one
using Triangle = std::array<Point, 3>;
using testing::Scratch;

constexpr std::array<std::uint64_t, 3> kDims{6, 5, 4};
constexpr std::size_t kFrames = 4;
constexpr float kIso = 0.5f;

Point minus(const Point& p, const Point& q) { return {p[0] - q[0], p[1] - q[1], p[2] - q[2]}; }
int dot(const Point& p, const Point& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }
Point cross(const Point& u, const Point& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

// Starts at the smallest corner; winding stays.
Triangle rotated(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

// The points of a plane's facet, fanned from the one lowest by z, y, x; counter-clockwise around the normal.
std::vector<Triangle> fan(std::vector<Point> facet, const Point& normal) {
  const auto by_zyx = [](const Point& p, const Point& q) {
    return std::array{p[2], p[1], p[0]} < std::array{q[2], q[1], q[0]};
  };
  std::iter_swap(facet.begin(), std::min_element(facet.begin(), facet.end(), by_zyx));
  std::sort(facet.begin() + 1, facet.end(), [&](const Point& p, const Point& q) {
    return dot(cross(minus(p, facet[0]), minus(q, facet[0])), normal) > 0;
  });
  std::vector<Triangle> triangles;
  for (std::size_t i = 1; i + 1 < facet.size(); ++i) triangles.push_back({facet[0], facet[i], facet[i + 1]});
  return triangles;
}

// Facets of hull(inside corners, midpoints of cut edges) that are in no wall of the cube, as triangles.
std::vector<Triangle> hullOfCube(unsigned inside) {
  std::vector<Point> points, midpoints;
  const auto corner = [](unsigned i) {
    return Point{2 * static_cast<int>(i & 1), static_cast<int>(i & 2), static_cast<int>(i & 4) / 2};
  };
  for (unsigned i = 0; i < 8; ++i) {
    if ((inside >> i & 1) != 0) points.push_back(corner(i));
    for (const unsigned axis : {1u, 2u, 4u}) {
      const unsigned j = i | axis;
      if (j == i || (inside >> i & 1) == (inside >> j & 1)) continue;
      const Point a = corner(i), b = corner(j);
      midpoints.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
    }
  }
  points.insert(points.end(), midpoints.begin(), midpoints.end());
  std::set<std::vector<Point>> seen;
  std::vector<Triangle> triangles;
  for (const Point& p : midpoints) {
    for (const Point& q : midpoints) {
      for (const Point& r : midpoints) {
        const Point normal = cross(minus(q, p), minus(r, p));
        if (normal == Point{0, 0, 0}) continue;
        std::vector<Point> facet;
        bool outer = true;
        for (const Point& s : points) {
          const int side = dot(normal, minus(s, p));
          outer &= side <= 0;
          if (side == 0) facet.push_back(s);
        }
        std::sort(facet.begin(), facet.end());
        const bool in_wall =
            std::count(normal.begin(), normal.end(), 0) == 2 &&
            std::all_of(facet.begin(), facet.end(), [&](const Point& s) {
              const auto axis = static_cast<std::size_t>(
                  std::find_if(normal.begin(), normal.end(), [](int n) { return n != 0; }) - normal.begin());
              return s[axis] % 2 == 0;
            });
        if (!outer || in_wall || !seen.insert(facet).second) continue;
        for (const Triangle& triangle : fan(facet, normal)) triangles.push_back(triangle);
      }
    }
  }
  return triangles;
}

// Marching cubes of frame k with that hull: triangles over doubled lattice points.
std::multiset<Triangle> marchingCubes(const Frames& frames, std::size_t k) {
  static std::map<unsigned, std::vector<Triangle>> hulls;
  std::multiset<Triangle> triangles;
  for (std::uint64_t z = 0; z + 1 < kDims[2]; ++z) {
    for (std::uint64_t y = 0; y + 1 < kDims[1]; ++y) {
      for (std::uint64_t x = 0; x + 1 < kDims[0]; ++x) {
        unsigned inside = 0;
        for (unsigned i = 0; i < 8; ++i) {
          if (frames.at(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2), k) >= kIso) inside |= 1u << i;
        }
        if (!hulls.contains(inside)) hulls[inside] = hullOfCube(inside);
        for (Triangle triangle : hulls[inside]) {
          for (Point& p : triangle) {
            p[0] += 2 * static_cast<int>(x), p[1] += 2 * static_cast<int>(y), p[2] += 2 * static_cast<int>(z);
          }
          triangles.insert(rotated(triangle));
        }
      }
    }
  }
  return triangles;
}

// The lattice edge a vertex of a frame's slice is on, as its doubled midpoint; it must be on one, at the linear
// crossing.
Point edgeOf(const Frames& frames, std::size_t k, const Vec3f& position) {
  const std::array<float, 3> p{position.x, position.y, position.z};
  Point doubled{};
  std::array<std::uint64_t, 3> low{}, high{};
  int fractions = 0;
  double fraction = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    low[c] = high[c] = static_cast<std::uint64_t>(std::floor(p[c]));
    doubled[c] = 2 * static_cast<int>(low[c]);
    if (p[c] == std::floor(p[c])) continue;
    ++fractions, ++doubled[c], ++high[c];
    fraction = double{p[c]} - std::floor(p[c]);
  }
  EXPECT_EQ(fractions, 1);
  const double v0 = frames.at(low[0], low[1], low[2], k), v1 = frames.at(high[0], high[1], high[2], k);
  EXPECT_NE(v0 >= kIso, v1 >= kIso);
  EXPECT_NEAR(fraction, (kIso - v0) / (v1 - v0), 2e-4);
  return doubled;
}

hypermesh::File extract(const Scratch& scratch, Frames& frames) {
  const std::string path = scratch.path("x.t4h");
  hypermesh::Options options;
  options.iso = kIso;
  auto writer = unwrap(hypermesh::Writer::create(path, hypermesh::meshHeader(frames, options), frames.times(), {},
                                                 paged::Codec::kRaw, true));
  outofcore::ThreadExecutor executor(1);
  outofcore::MemoryBudget memory(0);
  outofcore::Progress progress;
  hypermesh::buildHypermesh(frames, writer, options, executor, memory, progress);
  unwrap(writer.close("{}"));
  return unwrap(hypermesh::File::open(path));
}

Frames randomFrames(std::uint32_t seed, bool with_ties) {
  std::mt19937 random(seed);
  return Frames(kDims, kFrames, [&](std::uint64_t, std::uint64_t, std::uint64_t, std::uint64_t) {
    if (with_ties) return static_cast<float>(random() % 3) / 2;  // the isovalue itself is common
    return static_cast<float>(random() % 1024) / 1023;
  });
}

void expectMarchingCubes(const hypermesh::File& mesh, const Frames& frames, std::size_t k) {
  const SliceMesh slice = exchange::sliceHypermesh(mesh, static_cast<double>(k));
  std::vector<Point> edges;
  for (const Vec3f& position : slice.positions) edges.push_back(edgeOf(frames, k, position));
  EXPECT_EQ(std::set<Point>(edges.begin(), edges.end()).size(), edges.size()) << "one vertex an edge";
  std::multiset<Triangle> sliced;
  for (const auto& t : slice.triangles) sliced.insert(rotated({edges[t[0]], edges[t[1]], edges[t[2]]}));
  const auto expected = marchingCubes(frames, k);
  EXPECT_GT(expected.size(), 50u);
  EXPECT_EQ(sliced.size(), expected.size()) << "frame " << k;
  EXPECT_TRUE(sliced == expected) << "frame " << k;
  std::set<Point> cut;
  for (const Triangle& triangle : expected) cut.insert(triangle.begin(), triangle.end());
  EXPECT_EQ(cut, std::set<Point>(edges.begin(), edges.end()));
}

// Edges without their opposite must run in a wall of the domain.
void expectClosedButForWalls(const hypermesh::File& mesh, double frame) {
  const SliceMesh slice = exchange::sliceHypermesh(mesh, frame);
  ASSERT_FALSE(slice.triangles.empty());
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : slice.triangles) {
    for (std::size_t c = 0; c < 3; ++c) balance[std::minmax(t[c], t[(c + 1) % 3])] += t[c] < t[(c + 1) % 3] ? 1 : -1;
  }
  const auto coordinates = [&](std::uint32_t v) {
    return std::array{slice.positions[v].x, slice.positions[v].y, slice.positions[v].z};
  };
  std::size_t on_walls = 0;
  for (const auto& [edge, sum] : balance) {
    if (sum == 0) continue;
    ++on_walls;
    const auto a = coordinates(edge.first), b = coordinates(edge.second);
    bool in_wall = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const float far = static_cast<float>(kDims[c] - 1);
      in_wall |= (a[c] == 0 && b[c] == 0) || (a[c] == far && b[c] == far);
    }
    ASSERT_TRUE(in_wall) << "frame " << frame << ": an open edge inside the domain";
  }
  EXPECT_GT(on_walls, 0u);
}

TEST(FrameSlices, AreTheHullTablesMarchingCubesOfTheFrame) {
  const Scratch scratch;
  for (const bool with_ties : {false, true}) {
    for (std::uint32_t seed = 0; seed < 3; ++seed) {
      Frames frames = randomFrames(seed, with_ties);
      const hypermesh::File mesh = extract(scratch, frames);
      for (std::size_t k = 0; k < kFrames; ++k) expectMarchingCubes(mesh, frames, k);
    }
  }
}

TEST(FrameSlices, AreClosedButForTheWallsBetweenFramesToo) {
  const Scratch scratch;
  for (const bool with_ties : {false, true}) {
    Frames frames = randomFrames(7, with_ties);
    const hypermesh::File mesh = extract(scratch, frames);
    std::set<float> times;  // of the vertices themselves: where most edges end
    for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
      for (const Vec4f& v : unwrap(mesh.gather(k)).view.vertices) times.insert(v.t);
    }
    for (const double frame : {0.0, 0.1, 0.5, 1.0, 1.75, 2.0, 2.999, 3.0}) expectClosedButForWalls(mesh, frame);
    int tried = 0;
    for (const float t : times) {
      if (++tried % 16 == 0) expectClosedButForWalls(mesh, double{t});
    }
  }
}

TEST(FrameSlices, ShowNothingTwice) {
  const Scratch scratch;
  Frames frames = randomFrames(9, true);
  const hypermesh::File mesh = extract(scratch, frames);
  for (const double frame : {0.0, 1.0, 1.5, 2.0, 3.0}) {
    EXPECT_EQ(testing::repeatedTriangles(exchange::sliceHypermesh(mesh, frame)), 0u) << frame;
  }
}

}  // namespace
}  // namespace tet4d
