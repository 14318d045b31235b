// A scalar of a tetrahedral mesh as time: slices are isosurfaces, against marching tetrahedra by brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/hypermesh/scalar_time.h"
#include "libpreprocess/topology/check_hypermesh.h"

namespace tet4d::hypermesh {
namespace {

using exchange::TetMesh;
using Point = std::array<double, 3>;

double sixVolumes(const TetMesh& mesh, const std::array<std::uint32_t, 4>& tet) {
  Point e[3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) e[i][c] = mesh.points[tet[i + 1]][c] - mesh.points[tet[0]][c];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

// The unit cube in n^3 cubes of six tetrahedra each, all of positive volume.
TetMesh cube(std::uint32_t n, double (*scalar)(const Point&)) {
  TetMesh mesh;
  mesh.path = "cube";
  const std::uint32_t side = n + 1;
  for (std::uint32_t i = 0; i < side * side * side; ++i) {
    const Point p{static_cast<double>(i % side) / n, static_cast<double>(i / side % side) / n,
                  static_cast<double>(i / side / side) / n};
    mesh.points.push_back(p);
    mesh.scalar.push_back(scalar(p));
  }
  const std::array<std::uint32_t, 3> stride{1, side, side * side};
  for (std::uint32_t z = 0; z < n; ++z) {
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        std::array<std::size_t, 3> axes{0, 1, 2};
        do {
          std::array<std::uint32_t, 4> tet{x + side * (y + side * z)};
          for (std::size_t k = 0; k < 3; ++k) tet[k + 1] = tet[k] + stride[axes[k]];
          if (sixVolumes(mesh, tet) < 0) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  return mesh;
}

double waves(const Point& p) { return std::sin(7 * p[0]) + std::cos(5 * p[1] + p[2]) * 3 - 2 * p[2]; }
double alongX(const Point& p) { return p[0]; }

struct Surface {
  double area = 0;
  Point area_vector{};  // sum of areas times normals
  std::size_t vertices = 0;
};

// Adds a triangle whose normal is to point from high to low along `down`.
void addTriangle(Surface& surface, const Point& a, const Point& b, const Point& c, const Point& down) {
  Point u{}, w{};
  for (std::size_t i = 0; i < 3; ++i) u[i] = b[i] - a[i], w[i] = c[i] - a[i];
  Point n{(u[1] * w[2] - u[2] * w[1]) / 2, (u[2] * w[0] - u[0] * w[2]) / 2, (u[0] * w[1] - u[1] * w[0]) / 2};
  const double side = n[0] * down[0] + n[1] * down[1] + n[2] * down[2];
  surface.area += std::hypot(n[0], n[1], n[2]);
  for (std::size_t i = 0; i < 3; ++i) surface.area_vector[i] += side < 0 ? -n[i] : n[i];
}

// Marching tetrahedra, tetrahedron by tetrahedron: inside is scalar > v, or >= v, which differ at vertices only.
Surface marchingTets(const TetMesh& mesh, double v) {
  Surface surface;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& tet : mesh.tets) {
    std::vector<std::uint32_t> in, out;
    for (const std::uint32_t i : tet) (mesh.scalar[i] > v ? in : out).push_back(i);
    std::vector<Point> crossings;  // around the polygon
    const auto cross = [&](std::uint32_t a, std::uint32_t b) {
      edges[std::minmax(a, b)] = 1;
      const double l = (v - mesh.scalar[a]) / (mesh.scalar[b] - mesh.scalar[a]);
      Point p{};
      for (std::size_t c = 0; c < 3; ++c) p[c] = mesh.points[a][c] + l * (mesh.points[b][c] - mesh.points[a][c]);
      crossings.push_back(p);
    };
    if (in.size() == 1)
      for (const std::uint32_t o : out) cross(in[0], o);
    if (out.size() == 1)
      for (const std::uint32_t i : in) cross(i, out[0]);
    if (in.size() == 2) cross(in[0], out[0]), cross(in[0], out[1]), cross(in[1], out[1]), cross(in[1], out[0]);
    if (crossings.empty()) continue;
    Point down{};
    for (std::size_t c = 0; c < 3; ++c) {
      for (const std::uint32_t o : out) down[c] += mesh.points[o][c] / static_cast<double>(out.size());
      for (const std::uint32_t i : in) down[c] -= mesh.points[i][c] / static_cast<double>(in.size());
    }
    for (std::size_t k = 2; k < crossings.size(); ++k) {
      addTriangle(surface, crossings[0], crossings[k - 1], crossings[k], down);
    }
  }
  surface.vertices = edges.size();
  return surface;
}

class ScalarTime : public ::testing::Test {
 protected:
  ScalarTime() {
    std::string name = (std::filesystem::temp_directory_path() / "tet4d-sweep-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~ScalarTime() override { std::filesystem::remove_all(folder_); }

  // Writes the sweep of a mesh and opens it, proved.
  File sweep(TetMesh mesh, std::uint64_t frames = kSweepFrames) {
    ScalarSweep made(std::move(mesh), frames, memory_);
    orientation_ = made.orientation();
    shared_ = made.sharedFrames();
    const std::string path = (folder_ / "a.t4h").string();
    Writer writer = unwrap(Writer::create(path, made.header(), made.times(), {}, paged::Codec::kRaw, true));
    outofcore::Progress progress;
    made.write(writer, progress);
    unwrap(writer.close("{}"));
    File file = unwrap(File::open(path));
    unwrap(file.verify());
    const topology::HypermeshCheck check = topology::checkHypermesh(file, progress);
    for (const std::string& fault : check.faults) ADD_FAILURE() << fault;
    check_ = check;
    return file;
  }

  static Surface sliceOf(const File& file, double v) {
    const SliceMesh slice = exchange::sliceHypermesh(file, frameOfTime(file.times(), v));
    Surface surface;
    surface.vertices = slice.positions.size();
    for (const auto& triangle : slice.triangles) {
      std::array<Point, 3> p;
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3f& q = slice.positions[triangle[c]];
        p[c] = toWorld(file.header().index_to_world, {q.x, q.y, q.z});
      }
      Point u{}, w{};
      for (std::size_t i = 0; i < 3; ++i) u[i] = p[1][i] - p[0][i], w[i] = p[2][i] - p[0][i];
      const Point n{(u[1] * w[2] - u[2] * w[1]) / 2, (u[2] * w[0] - u[0] * w[2]) / 2, (u[0] * w[1] - u[1] * w[0]) / 2};
      surface.area += std::hypot(n[0], n[1], n[2]);
      for (std::size_t i = 0; i < 3; ++i) surface.area_vector[i] += n[i];
    }
    return surface;
  }

  void expectIsosurfaces(const TetMesh& mesh, const File& file, double tolerance) {
    const double low = file.times().front(), high = file.times().back();
    for (const double part : {0.003, 0.1234, 0.31, 0.5021, 0.777, 0.9, 0.9971}) {
      const double v = low + part * (high - low);
      const Surface expected = marchingTets(mesh, v), found = sliceOf(file, v);
      EXPECT_EQ(found.vertices, expected.vertices) << v;
      EXPECT_NEAR(found.area, expected.area, tolerance) << v;
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found.area_vector[c], expected.area_vector[c], tolerance) << v;
    }
  }

  Fault faultOf(TetMesh mesh, std::uint64_t frames = kSweepFrames) {
    try {
      ScalarSweep made(std::move(mesh), frames, memory_);
    } catch (const Error& error) {
      return error.fault();
    }
    ADD_FAILURE() << "no error";
    return {};
  }

  std::filesystem::path folder_;
  outofcore::MemoryBudget memory_;
  Orientation orientation_;
  topology::HypermeshCheck check_;
  std::uint64_t shared_ = 0;
};

TEST_F(ScalarTime, SlicesAreTheIsosurfacesOfMarchingTetrahedra) {
  const TetMesh mesh = cube(9, waves);
  for (const std::uint64_t frames : {2U, 3U, 65U, 500U}) {
    const File file = sweep(mesh, frames);
    EXPECT_EQ(file.geometryPages(), frames - 1);
    EXPECT_EQ(file.header().tets, mesh.tets.size());
    EXPECT_EQ(file.header().vertices, mesh.points.size());
    EXPECT_EQ(check_.wall_faces + check_.inner_boundary_faces, 12U * 9 * 9);
    expectIsosurfaces(mesh, file, 2e-5);
  }
}

TEST_F(ScalarTime, APlaneWindsTowardsLowerValues) {
  const File file = sweep(cube(4, alongX));
  const Surface plane = sliceOf(file, 0.6);
  EXPECT_NEAR(plane.area, 1, 1e-6);
  EXPECT_NEAR(plane.area_vector[0], -1, 1e-6);
  // At vertices' own value too, where faces of tetrahedra lie in the plane: each once.
  EXPECT_NEAR(sliceOf(file, 0.5).area, 1, 1e-6);
  EXPECT_NEAR(sliceOf(file, 0.5).area_vector[0], -1, 1e-6);
}

TEST_F(ScalarTime, TheSameWhateverTheOrderOfTheTetrahedra) {
  const TetMesh mesh = cube(5, waves);
  TetMesh all = mesh, some = mesh;
  for (auto& tet : all.tets) std::swap(tet[0], tet[1]);
  std::mt19937 random(7);
  std::uint64_t turned = 0;
  for (auto& tet : some.tets) {
    if (random() % 3 != 0) continue;
    std::swap(tet[1], tet[3]);
    ++turned;
  }
  const File first = sweep(all);
  EXPECT_EQ(orientation_.negative, mesh.tets.size());
  expectIsosurfaces(mesh, first, 1e-5);
  const File second = sweep(some);
  EXPECT_EQ(orientation_.negative, turned);
  EXPECT_EQ(orientation_.inverted, 0U);
  expectIsosurfaces(mesh, second, 1e-5);
}

using ScalarTimeStiff = ScalarTime;

TEST_F(ScalarTimeStiff, TetrahedraWithoutVolumeAreOrderedByTheirNeighbours) {
  TetMesh mesh = cube(4, waves);
  // One inner vertex moves into its neighbour: the tetrahedra of that edge are flat, those behind it lean over.
  mesh.points[62] = mesh.points[63];
  std::mt19937 random(3);
  for (auto& tet : mesh.tets) {
    if (random() % 2 != 0) std::swap(tet[0], tet[2]);
  }
  sweep(mesh);
  EXPECT_GT(orientation_.degenerate, 0U);
}

TEST_F(ScalarTimeStiff, AFoldedMeshStaysConsistentAndIsCounted) {
  TetMesh mesh = cube(4, waves);
  mesh.points[62] = {mesh.points[62][0] + 0.4, mesh.points[62][1], mesh.points[62][2]};  // over its neighbour
  sweep(mesh);
  EXPECT_GT(orientation_.inverted, 0U);
  EXPECT_LT(orientation_.inverted, 24U);
}

TEST_F(ScalarTimeStiff, TetrahedraOfOneValueAreLegal) {
  const TetMesh mesh = cube(6, [](const Point& p) { return std::floor(p[0] * 3) + p[1] * 0; });
  sweep(mesh);
  EXPECT_GT(check_.flat_time_tets, 0U);
}

TEST_F(ScalarTimeStiff, FarFromTheOriginWithTinyCells) {
  TetMesh mesh = cube(6, waves);
  TetMesh far = mesh;
  for (auto& p : far.points) {
    for (std::size_t c = 0; c < 3; ++c) p[c] = 1e7 + 0.1 * static_cast<double>(c) + 1e-3 * p[c];
  }
  const File file = sweep(far);
  for (const double v : {-1.1, 0.321, 2.2}) {
    const Surface near_origin = marchingTets(mesh, v), found = sliceOf(file, v);
    EXPECT_EQ(found.vertices, near_origin.vertices);
    EXPECT_NEAR(found.area * 1e6, near_origin.area, 1e-4);  // 1e7 keeps 2e-9 in double
  }
}

TEST_F(ScalarTimeStiff, ScalarsNearTheirLimits) {
  const TetMesh mesh = cube(4, waves);
  const double low = *std::min_element(mesh.scalar.begin(), mesh.scalar.end());
  const double high = *std::max_element(mesh.scalar.begin(), mesh.scalar.end());
  // Half the range and its middle; the first range is beyond the largest double.
  for (const auto& [half, middle] :
       std::vector<std::pair<double, double>>{{1.7e308, 0}, {1e-300, 0}, {1e-3, 1e9}, {3e7, 3e7 + 0.1}}) {
    TetMesh scaled = mesh;
    for (double& s : scaled.scalar) s = ((s - low) / (high - low) * 2 - 1) * half + middle;
    const File file = sweep(scaled);
    const Surface expected = marchingTets(mesh, low + 0.4 * (high - low));
    const double v = 2 * (file.times().front() / 2 + 0.4 * (file.times().back() / 2 - file.times().front() / 2));
    EXPECT_NEAR(sliceOf(file, v).area, expected.area, 1e-3) << half;
  }
}

TEST_F(ScalarTimeStiff, ValuesThatFloatCannotTellApartAreCounted) {
  TetMesh mesh = cube(1, alongX);
  mesh.scalar = {0, 0.5, 0.5 + 1e-9, 0.5 + 2e-9, 0.7, 0.8, 0.9, 1};
  sweep(mesh);
  EXPECT_EQ(shared_, 2U);
  // Near the least value float32 tells almost everything apart.
  mesh.scalar = {0, 1e-30, 1.0001e-30, 1e-20, 1e-10, 1.000001e-10, 0.5, 1};
  sweep(mesh);
  EXPECT_EQ(shared_, 0U);
}

TEST_F(ScalarTime, Refusals) {
  const TetMesh mesh = cube(2, waves);
  TetMesh bad = mesh;
  bad.scalar[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(faultOf(bad).place, "vertex 5");
  bad.scalar[5] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(faultOf(bad).place, "vertex 5");
  bad = mesh;
  std::fill(bad.scalar.begin(), bad.scalar.end(), 7.0);
  EXPECT_NE(faultOf(bad).what.find("7 at every vertex"), std::string::npos);
  bad = mesh;
  bad.tets[3][1] = bad.tets[3][2];
  EXPECT_EQ(faultOf(bad).place, "tetrahedron 3");
  EXPECT_EQ(faultOf(mesh, 1).code, FaultCode::kUsage);
  EXPECT_EQ(faultOf(mesh, std::uint64_t{1} << 40).code, FaultCode::kUsage);
  bad = mesh;
  for (double& s : bad.scalar) s = s > 0 ? std::nextafter(1.0, 2.0) : 1.0;
  EXPECT_NE(faultOf(bad).what.find("does not hold 65 numbers"), std::string::npos);
  bad = mesh;
  bad.tets.push_back(bad.tets[0]);
  std::swap(bad.tets.back()[0], bad.tets.back()[1]);
  bad.points.push_back({5, 5, 5});
  bad.scalar.push_back(0);
  bad.tets.push_back(
      {bad.tets[0][0], bad.tets[0][1], bad.tets[0][2], static_cast<std::uint32_t>(bad.points.size() - 1)});
  EXPECT_NE(faultOf(bad).what.find("three tetrahedra"), std::string::npos);
}

TEST_F(ScalarTime, VerticesThatNoTetrahedronUsesDoNotCount) {
  TetMesh mesh = cube(2, waves);
  mesh.points.insert(mesh.points.begin(), {1e300, 0, 0});
  mesh.scalar.insert(mesh.scalar.begin(), std::numeric_limits<double>::quiet_NaN());
  for (auto& tet : mesh.tets) {
    for (std::uint32_t& v : tet) ++v;
  }
  const File file = sweep(mesh);
  EXPECT_EQ(file.header().vertices, 27U);
  EXPECT_EQ(check_.unused_vertices, 0U);
}

}  // namespace
}  // namespace tet4d::hypermesh
