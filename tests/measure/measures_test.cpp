#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "formats/core/slicer.h"
#include "libpreprocess/error.h"
#include "libpreprocess/measure/compensated_sum.h"
#include "libpreprocess/measure/hypermesh_measures.h"
#include "libpreprocess/measure/slice_measures.h"
#include "tests/measure/sphere.h"
#include "tests/topology/space_time_meshes.h"

namespace tet4d::measure {
namespace {

using testing::SpaceTimeMesh;

HypermeshMeasures measured(const SpaceTimeMesh& mesh) { return measureHypermesh(mesh.vertices, mesh.tets); }

// A cube of half edge `half(t)` whose centre is at `speed` t along x.
SpaceTimeMesh cube(std::size_t frames, float speed, float half, float growth, float far = 0) {
  return testing::extrude(testing::cubeTriangles(), frames, [=](std::size_t k) {
    auto corners = testing::cubeCorners();
    const float t = static_cast<float>(k), h = half + growth * t;
    for (Vec3f& p : corners) p = {far + h * p.x + speed * t, far + h * p.y, far + h * p.z};
    return corners;
  });
}

TEST(CompensatedSum, KeepsWhatAPlainSumLoses) {
  CompensatedSum sum;
  for (const double term : {1.0, 1e100, 1.0, -1e100}) sum.add(term);
  EXPECT_EQ(sum.value(), 2.0);
  CompensatedSum tenths;
  for (int i = 0; i < 10'000'000; ++i) tenths.add(0.1);
  EXPECT_DOUBLE_EQ(tenths.value(), 1e6);
}

TEST(HypermeshMeasures, PolytopesAreExact) {
  const HypermeshMeasures simplex = measured(testing::simplexBoundary());
  ASSERT_TRUE(simplex.volume4);
  EXPECT_NEAR(*simplex.volume4, 1.0 / 24, 1e-15);
  // Four facets of volume 1/6, and the one between the unit points: edge sqrt(2), and 4D normal (1, 1, 1, 1) / 6.
  EXPECT_NEAR(simplex.volume3, 4.0 / 6 + 2.0 / 6, 1e-15);
  EXPECT_LT(simplex.closure, 1e-15);
  const HypermeshMeasures cross = measured(testing::crossPolytopeBoundary());
  EXPECT_NEAR(cross.volume4.value(), 2.0 / 3, 1e-15);
  EXPECT_NEAR(cross.volume3, 16.0 / 3, 1e-14);
}

TEST(HypermeshMeasures, InsideOutIsNegative) {
  SpaceTimeMesh mesh = testing::crossPolytopeBoundary();
  for (auto& tet : mesh.tets) std::swap(tet[0], tet[1]);
  EXPECT_NEAR(measured(mesh).volume4.value(), -2.0 / 3, 1e-15);
}

TEST(HypermeshMeasures, BoxesThatStandMoveAndGrow) {
  const HypermeshMeasures still = measured(cube(5, 0, 1, 0));
  EXPECT_NEAR(still.volume4.value(), 8.0 * 4, 1e-12);
  EXPECT_NEAR(still.volume3, 24.0 * 4, 1e-12);
  EXPECT_NEAR(still.swept_area, 24.0 * 4, 1e-12);
  // Moved along x by 3/4 cell a frame, the two faces across the motion grow by sqrt(1 + 9/16).
  const HypermeshMeasures moved = measured(cube(5, 0.75f, 1, 0));
  EXPECT_NEAR(moved.volume4.value(), 8.0 * 4, 1e-12);
  EXPECT_NEAR(moved.volume3, (16 + 8 * 1.25) * 4, 1e-12);
  EXPECT_NEAR(moved.swept_area, 24.0 * 4, 1e-12);
  // Half edge 1 to 3 in four frames: integrals of (2h)^3 and 6 (2h)^2, each face at normal speed 1/2.
  const HypermeshMeasures grown = measured(cube(5, 0, 1, 0.5f));
  EXPECT_NEAR(grown.volume4.value(), 8 * (81.0 - 1) / 4 / 0.5, 1e-11);
  EXPECT_NEAR(grown.swept_area, 24 * (27.0 - 1) / 3 / 0.5, 1e-11);
  EXPECT_NEAR(grown.volume3, 24 * (27.0 - 1) / 3 / 0.5 * std::sqrt(1.25), 1e-11);
}

TEST(HypermeshMeasures, FarFromTheOriginNothingIsLost) {
  // 2^20 cells away, f32 coordinates are still exact for this cube.
  const SpaceTimeMesh far = cube(3, 0.5f, 1, 0, 1048576);
  EXPECT_NEAR(measured(far).volume3, (16 + 8 * std::sqrt(1.25)) * 2, 1e-11);
  const std::string path = testing::temporaryFile("far.t4h");
  testing::writeFile(path, far, hypermesh::kOnGrid, testing::farDomain(far));
  outofcore::Progress progress;
  const auto file = unwrap(hypermesh::File::open(path));
  EXPECT_NEAR(measureHypermesh(file, progress).volume4.value(), 16, 1e-11);
  std::filesystem::remove(path);
}

TEST(HypermeshMeasures, FilesGiveTheSameWhateverThePages) {
  const SpaceTimeMesh mesh = cube(4, 0.75f, 1, 0.5f);
  const std::string path = testing::temporaryFile("mesh.t4h");
  testing::Pages pages{{8, 16, 32}, {}};
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) pages.page_of_tet.push_back(i * 3 / mesh.tets.size());
  testing::writeFile(path, mesh, pages, hypermesh::kOnGrid, testing::farDomain(mesh));
  outofcore::Progress progress;
  const HypermeshMeasures file = measureHypermesh(unwrap(hypermesh::File::open(path)), progress);
  const HypermeshMeasures core = measured(mesh);
  EXPECT_EQ(file.tets, core.tets);
  EXPECT_NEAR(file.volume3, core.volume3, 1e-12 * core.volume3);
  EXPECT_NEAR(file.volume4.value(), core.volume4.value(), 1e-12 * *core.volume4);
  EXPECT_NEAR(file.volume4_world.value(), *core.volume4, 1e-12 * *core.volume4);
  std::filesystem::remove(path);
}

TEST(HypermeshMeasures, NoEnclosedVolumeWhereThereIsNoInside) {
  const SpaceTimeMesh mesh = cube(3, 0, 1, 0);
  Bounds4f domain = testing::farDomain(mesh);
  const std::vector<double> times{0, 1, 2};
  const auto volume4 = [&](bool closed) {
    HypermeshMeter meter(domain, closed, AffineMap{}, times);
    meter.add(mesh.vertices, mesh.tets);
    return meter.result().volume4;
  };
  EXPECT_TRUE(volume4(true));
  EXPECT_FALSE(volume4(false));
  domain.max.y = 1;  // now a face of the cube lies on a wall
  EXPECT_FALSE(volume4(true));
}

TEST(HypermeshMeasures, OpenSlicesShow) {
  SpaceTimeMesh mesh = cube(3, 0, 1, 0);
  EXPECT_LT(measured(mesh).closure, 1e-15);
  mesh.tets.resize(mesh.tets.size() - 6);
  EXPECT_GT(measured(mesh).closure, 0.01);
}

TEST(HypermeshMeasures, WorldUnitsAndUnevenTimes) {
  const SpaceTimeMesh mesh = cube(3, 0.5f, 1, 0);
  // A sheared map of determinant -6, and frames of 0.25 s and 4 s: the cube's volume 8 is swept over 4.25 s.
  const AffineMap map{{1e7, -5, 3}, {{{2, 0, 0}, {1, -3, 0}, {7, 1, 1}}}};
  const std::vector<double> times{1.5e9, 1.5e9 + 0.25, 1.5e9 + 4.25};
  HypermeshMeter meter(testing::farDomain(mesh), true, map, times);
  meter.add(mesh.vertices, mesh.tets);
  EXPECT_NEAR(meter.result().volume4_world.value(), 6 * 8 * 4.25, 1e-9);
  EXPECT_NEAR(meter.result().volume4.value(), 16, 1e-12);
}

TEST(HypermeshMeasures, CountsHypercubes) {
  // Small cubes in known cells: half edge 1/4 inside the cell (2, 3, 4), frames 0..2: two hypercubes.
  const SpaceTimeMesh small = testing::extrude(testing::cubeTriangles(), 3, [](std::size_t) {
    auto corners = testing::cubeCorners();
    for (Vec3f& p : corners) p = {2.5f + p.x / 4, 3.5f + p.y / 4, 4.5f + p.z / 4};
    return corners;
  });
  const HypermeshMeasures measures = measured(small);
  EXPECT_EQ(measures.active_cells, 2u);
  EXPECT_DOUBLE_EQ(measures.tetsPerActiveCell(), 36);
  EXPECT_EQ(measured({}).tetsPerActiveCell(), 0);
}

TEST(SliceMeasures, ACube) {
  const auto corners = testing::cubeCorners();
  auto triangles = testing::cubeTriangles();
  const SliceMeasures whole = measureSlice(corners, triangles);
  EXPECT_NEAR(whole.area, 24, 1e-14);
  EXPECT_NEAR(whole.volume, 8, 1e-14);
  EXPECT_TRUE(whole.closed());
  EXPECT_EQ(whole.edges, 18u);
  EXPECT_EQ(whole.euler(), 2);
  // Half as high, mirrored and far away: the volume keeps its sign.
  const SliceMeasures mapped = measureSlice(corners, triangles, {{1e9, 0, 0}, {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}}});
  EXPECT_NEAR(mapped.volume, 4, 1e-14);
  EXPECT_NEAR(mapped.area, 16, 1e-14);

  std::swap(triangles[0][0], triangles[0][1]);
  EXPECT_EQ(measureSlice(corners, triangles).misoriented_edges, 3u);
  triangles[0] = triangles[1];
  const SliceMeasures doubled = measureSlice(corners, triangles);
  EXPECT_EQ(doubled.edges_over_two, 2u);
  EXPECT_EQ(doubled.boundary_edges, 2u);
  EXPECT_FALSE(doubled.closed());
  triangles.pop_back();
  EXPECT_EQ(measureSlice(corners, testing::Triangles(triangles.begin() + 1, triangles.end())).boundary_edges, 6u);
  EXPECT_TRUE(measureSlice({}, {}).closed());
}

// A sheet laid upon itself bounds nothing and changes no volume, where it is alone or where it touches.
TEST(SliceMeasures, SheetsUponEachOtherStillBoundTheVolume) {
  auto corners = testing::cubeCorners();
  auto triangles = testing::cubeTriangles();
  const auto far = static_cast<std::uint32_t>(corners.size());
  corners.push_back({7, 8, 9});
  triangles.push_back({triangles[0][0], triangles[0][1], far});
  triangles.push_back({triangles[0][1], triangles[0][0], far});
  const SliceMeasures folded = measureSlice(corners, triangles);
  EXPECT_FALSE(folded.closed());
  EXPECT_EQ(folded.edges_over_two, 1u);
  EXPECT_TRUE(folded.bounds());
  EXPECT_NEAR(folded.volume, 8, 1e-12);
  triangles.pop_back();
  EXPECT_EQ(measureSlice(corners, triangles).unbalanced_edges, 3u);
  EXPECT_FALSE(measureSlice(corners, triangles).bounds());
}

TEST(SliceMeasures, SlicesOfABoxThatMovesAndGrows) {
  const SpaceTimeMesh mesh = cube(5, 0.75f, 1, 0.5f);
  for (const float t : {0.0f, 0.3f, 1.0f, 2.625f, 4.0f}) {
    SliceMesh slice;
    sliceTets(mesh.tets, mesh.vertices, {}, t, 4, slice);
    const SliceMeasures measures = measureSlice(slice.positions, slice.triangles);
    const double edge = 2 * (1 + 0.5 * t);
    EXPECT_TRUE(measures.closed()) << t;
    EXPECT_EQ(measures.euler(), 2) << t;
    EXPECT_NEAR(measures.area, 6 * edge * edge, 1e-5 * measures.area) << t;
    EXPECT_NEAR(measures.volume, edge * edge * edge, 1e-5 * measures.volume) << t;
  }
}

// The closed forms of sphere.h against sums over the sphere and time.
TEST(MovingBall, ClosedFormsAreThoseOfQuadrature) {
  for (const testing::MovingBall& ball :
       {testing::MovingBall{{0, 0, 0}, {0, 0, 0}, 2, 0}, testing::MovingBall{{0, 0, 0}, {0.3, -0.8, 1.1}, 2, 0},
        testing::MovingBall{{0, 0, 0}, {0.3, 0.2, 0}, 2, 0.7}, testing::MovingBall{{0, 0, 0}, {0, 0, 0}, 5, -0.5}}) {
    const double last = 6;
    const int n = 400;
    double volume3 = 0, volume4 = 0;
    const double v = std::hypot(ball.velocity[0], ball.velocity[1], ball.velocity[2]);
    for (int i = 0; i < n; ++i) {
      const double t = (i + 0.5) * last / n;
      volume4 += ball.sliceVolume(t) * last / n;
      for (int j = 0; j < n; ++j) {
        const double u = -1 + (j + 0.5) * 2 / n;
        volume3 += ball.sliceArea(t) * std::hypot(1.0, v * u + ball.growth) / n * last / n;
      }
    }
    EXPECT_NEAR(volume3, ball.volume3(last), 1e-5 * volume3);
    EXPECT_NEAR(volume4, ball.volume4(last), 1e-5 * volume4);
  }
}

}  // namespace
}  // namespace tet4d::measure
