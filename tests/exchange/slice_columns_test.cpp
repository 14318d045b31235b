// Values on slices: columns interpolated across pages, the velocity of the surface.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/exchange/world_mesh.h"
#include "tests/exchange/support.h"
#include "tests/topology/space_time_meshes.h"

namespace tet4d::exchange {
namespace {

using testing::cubesBoundary;
using testing::randomCells;
using testing::Scratch;
using testing::SpaceTime;
using testing::VertexColumn;

const std::vector<double> kTimes{100, 100.5, 102, 103};

double linear(double x, double y, double z, double t) { return 2 * x - y + 3 * z + 0.5 * t - 1; }

// Three slabs with a column of the places themselves, a linear one, unit normals that turn, and one of zeros.
hypermesh::File columnedFile(const Scratch& scratch) {
  const SpaceTime mesh = cubesBoundary(3, randomCells(3, 0.5, 11));
  std::vector<VertexColumn> columns{{"place", 4, {}}, {"linear", 1, {}}, {"normal", 3, {}}, {"wind", 2, {}}};
  for (const Vec4f& v : mesh.vertices) {
    for (const float x : {v.x, v.y, v.z, v.t}) columns[0].values.push_back(x);
    columns[1].values.push_back(static_cast<float>(linear(v.x, v.y, v.z, v.t)));
    const float turn = v.t + v.x;
    const bool none = v.y == 0;
    for (const float x : {std::cos(turn), std::sin(turn), 0.0f}) columns[2].values.push_back(none ? 0 : x);
    columns[3].values.insert(columns[3].values.end(), {v.z, std::numeric_limits<float>::infinity()});
  }
  testing::writeSlabs(scratch.path("c.t4h"), mesh, 4, {}, kTimes, columns);
  return unwrap(hypermesh::File::open(scratch.path("c.t4h")));
}

TEST(SliceColumns, AreInterpolatedAsPositionsAreAcrossPages) {
  const Scratch scratch;
  const hypermesh::File file = columnedFile(scratch);
  ASSERT_EQ(file.geometryPages(), 3u);
  for (const double frame : {0.0, 0.25, 1.0, 1.7, 2.0, 2.999, 3.0}) {
    const Slice slice = sliceHypermesh(file, frame, {{1, 0}, false, {}});
    ASSERT_EQ(slice.columns.size(), 2u) << "what was not asked for is left out";
    EXPECT_EQ(slice.columns[0].name, "linear");
    EXPECT_EQ(slice.columns[1].name, "place");
    EXPECT_EQ(slice.mesh.keys, sliceHypermesh(file, frame).keys);
    ASSERT_FALSE(slice.mesh.positions.empty());
    ASSERT_EQ(slice.columns[1].values.size(), 4 * slice.mesh.positions.size());
    const bool exact = frame == std::floor(frame);
    for (std::size_t i = 0; i < slice.mesh.positions.size(); ++i) {
      const Vec3f& p = slice.mesh.positions[i];
      const float* place = &slice.columns[1].values[4 * i];
      const double tolerance = exact ? 0 : 1e-6;
      ASSERT_NEAR(place[0], p.x, tolerance) << frame;
      ASSERT_NEAR(place[1], p.y, tolerance) << frame;
      ASSERT_NEAR(place[2], p.z, tolerance) << frame;
      ASSERT_NEAR(place[3], frame, tolerance) << frame;
      ASSERT_NEAR(slice.columns[0].values[i], linear(p.x, p.y, p.z, frame), 10 * tolerance) << frame;
    }
  }
}

TEST(SliceColumns, NormalsStayUnitAndZeroStaysZero) {
  const Scratch scratch;
  const hypermesh::File file = columnedFile(scratch);
  const Slice slice = sliceHypermesh(file, 1.5, {{2}, false, {}});
  std::size_t zeros = 0, turned = 0;
  for (std::size_t i = 0; i < slice.mesh.positions.size(); ++i) {
    const float* n = &slice.columns[0].values[3 * i];
    const double length = std::hypot(double{n[0]}, double{n[1]}, double{n[2]});
    zeros += length == 0;
    if (length == 0) continue;
    ASSERT_NEAR(length, 1, 1e-6);
    turned += slice.mesh.keys[i].a != slice.mesh.keys[i].b;
  }
  EXPECT_GT(zeros, 0u);
  EXPECT_GT(turned, 0u);
  const Slice wind = sliceHypermesh(file, 1.5, {{3}, false, {}});
  EXPECT_TRUE(std::isinf(wind.columns[0].values[1])) << "an infinity at both ends is one between them";
}

TEST(SliceColumns, ADamagedColumnOfAnotherPageIsNamed) {
  const Scratch scratch;
  std::string bytes;
  std::uint64_t offset = 0;
  {
    const hypermesh::File file = columnedFile(scratch);
    bytes = testing::readFile(scratch.path("c.t4h"));
    offset = file.pages().entries()[1 * 5 + 2].offset;  // column "linear" of page 1
  }
  bytes[offset] = static_cast<char>(bytes[offset] ^ 1);
  const auto file = unwrap(hypermesh::File::open(scratch.write("bad.t4h", bytes)));
  EXPECT_FALSE(sliceHypermesh(file, 0.5, {{0}, false, {}}).mesh.triangles.empty())
      << "what is not asked for is not read";
  const Fault fault = testing::faultOf([&] { sliceHypermesh(file, 0.5, {{1}, false, {}}); });
  EXPECT_EQ(fault.code, FaultCode::kBadInput) << "page 0 needs its neighbour's values";
  EXPECT_NE((fault.place + fault.what).find("page 7"), std::string::npos) << fault.place << ": " << fault.what;
}

// A flat sheet of triangles in the plane z = 0 of index space, moved by w a frame.
testing::SpaceTimeMesh movingSheet(const Vec3f& w) {
  testing::Triangles triangles;
  for (std::uint32_t j = 0; j < 3; ++j) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t v = 4 * j + i;
      triangles.push_back({v, v + 1, v + 5});
      triangles.push_back({v, v + 5, v + 4});
    }
  }
  return testing::extrude(triangles, 3, [&](std::size_t k) {
    std::vector<Vec3f> places;
    const auto t = static_cast<float>(k);
    for (std::uint32_t v = 0; v < 16; ++v) {
      const auto x = static_cast<float>(v % 4), y = static_cast<float>(v) / 4 - x / 4;
      places.push_back({x + t * w.x, y + t * w.y, t * w.z});
    }
    return places;
  });
}

TEST(SliceVelocity, OfAPlaneIsItsNormalPartInTheWorld) {
  AffineMap map;  // sheared and mirrored
  map.axes = {{{2, 0, 0}, {1, 3, 0}, {0.5, -1, -4}}};
  const Vec3f w{0.5f, -0.25f, 0.75f};
  const testing::SpaceTimeMesh mesh = movingSheet(w);
  // The plane's normal in the world is z; of the motion w . axes only that part counts.
  for (const auto& [t, step] :
       {std::pair{0.25f, 0.5}, std::pair{1.0f, 1.5}, std::pair{1.75f, 1.5}, std::pair{2.0f, 1.5}}) {
    TetSlicer slicer(t, 2);
    slicer.add(mesh.tets, mesh.vertices, {});
    TetVelocity velocity(map, std::vector<double>{100, 100.5, 102}, t);
    velocity.add(slicer, mesh.tets, mesh.vertices);
    ASSERT_FALSE(slicer.mesh().triangles.empty()) << t;
    const MeshColumn column = velocity.column(slicer.mesh().positions.size());
    EXPECT_EQ(column.name, "velocity");
    for (std::size_t i = 0; i < column.values.size(); i += 3) {
      ASSERT_NEAR(column.values[i], 0, 1e-6) << t;
      ASSERT_NEAR(column.values[i + 1], 0, 1e-6) << t;
      ASSERT_NEAR(column.values[i + 2], -4 * 0.75 / step, 1e-5) << t;
    }
  }
}

TEST(SliceVelocity, OfAGrowingCubeIsOutward) {
  // The cube's corners pushed out: every facet moves along its own outward normal, one unit a frame.
  const auto mesh = testing::extrude(testing::cubeTriangles(), 3, [](std::size_t k) {
    std::vector<Vec3f> places = testing::cubeCorners();
    const auto s = static_cast<float>(k + 1);
    for (Vec3f& p : places) p = {s * p.x, s * p.y, s * p.z};
    return places;
  });
  TetSlicer slicer(0.5f, 2);
  slicer.add(mesh.tets, mesh.vertices, {});
  TetVelocity velocity({}, std::vector<double>{0, 1, 2}, 0.5f);
  velocity.add(slicer, mesh.tets, mesh.vertices);
  const SliceMesh& slice = slicer.mesh();
  const MeshColumn column = velocity.column(slice.positions.size());
  std::size_t in_facets = 0;
  for (std::size_t i = 0; i < slice.positions.size(); ++i) {
    const std::array<float, 3> p{slice.positions[i].x, slice.positions[i].y, slice.positions[i].z};
    int walls = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const bool on_wall = std::abs(std::abs(p[c]) - 1.5f) < 1e-6f;
      walls += on_wall ? 1 : 0;
      EXPECT_GT(column.values[3 * i + c] * p[c], -1e-5f) << "inward";
      EXPECT_LE(std::abs(column.values[3 * i + c]), 1 + 1e-5);
    }
    ASSERT_GE(walls, 1);
    if (walls > 1) continue;
    ++in_facets;
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = std::abs(p[c]) > 1.499f ? std::copysign(1.0, double{p[c]}) : 0.0;
      EXPECT_NEAR(column.values[3 * i + c], expected, 1e-5);
    }
  }
  EXPECT_GT(in_facets, 0u);
}

TEST(SliceVelocityStiff, TinyStepsOfTimeAndFlatTetrahedraStayFinite) {
  testing::SpaceTimeMesh mesh = movingSheet({0, 0, 1});
  for (const double step : {1e-9, 1e-300, 1e9}) {
    TetSlicer slicer(0.5f, 2);
    slicer.add(mesh.tets, mesh.vertices, {});
    TetVelocity velocity({}, std::vector<double>{0, step, 2 * step}, 0.5f);
    velocity.add(slicer, mesh.tets, mesh.vertices);
    const MeshColumn column = velocity.column(slicer.mesh().positions.size());
    for (const float x : column.values) ASSERT_TRUE(std::isfinite(x)) << step;
    if (step != 1e-300) {
      EXPECT_NEAR(column.values[2] * step, 1, 1e-5);
    }
  }
  // Nearly at one time: a birth, almost infinitely fast.
  const std::vector<Vec4f> flat{{0, 0, 0, 1}, {1, 0, 0, 1.0000001f}, {0, 1, 0, 1}, {0, 0, 1, 1.0000001f}};
  TetSlicer slicer(1, 2);
  slicer.add(std::vector<hypermesh::Tet>{{0, 1, 2, 3}}, flat, {});
  TetVelocity velocity({}, std::vector<double>{0, 1, 2}, 1);
  velocity.add(slicer, std::vector<hypermesh::Tet>{{0, 1, 2, 3}}, flat);
  for (const float x : velocity.column(slicer.mesh().positions.size()).values) EXPECT_TRUE(std::isfinite(x));
}

TEST(TetSlicer, PiecesAreWeldedAndTellWhereTheyCameFrom) {
  const SpaceTime mesh = cubesBoundary(2, randomCells(2, 0.5, 3));
  std::vector<std::uint64_t> ids(mesh.vertices.size());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = i;
  for (const float t : {0.0f, 0.5f, 1.0f, 1.25f}) {
    TetSlicer whole(t, 2), pieces(t, 2);
    whole.add(mesh.tets, mesh.vertices, ids);
    const std::size_t half = mesh.tets.size() / 2;
    pieces.add(std::span(mesh.tets).first(half), mesh.vertices, ids);
    pieces.add(std::span(mesh.tets).subspan(half), mesh.vertices, ids);
    EXPECT_EQ(pieces.mesh().keys, whole.mesh().keys) << t;
    EXPECT_EQ(pieces.mesh().triangles, whole.mesh().triangles) << t;
    ASSERT_EQ(whole.tets().size(), whole.mesh().triangles.size());
    for (std::size_t i = 0; i < whole.tets().size(); ++i) {
      for (const std::uint32_t corner : whole.mesh().triangles[i]) {
        const auto& tet = mesh.tets[whole.tets()[i]];
        for (const std::uint32_t end : whole.ends()[corner]) EXPECT_EQ(std::count(tet.begin(), tet.end(), end), 1);
      }
    }
  }
}

}  // namespace
}  // namespace tet4d::exchange
