// Surfaces nobody would choose, and what becomes of them.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/core/coordinates.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "tests/prisms/moving_surfaces.h"

namespace tet4d::testing {
namespace {

using Points = std::vector<std::array<double, 3>>;

std::array<double, 3> bent(double x, double y, std::size_t k) {
  const auto t = static_cast<double>(k);
  return {x, y, (1 + x + 2 * y) * std::sin(t)};
}

TEST(PrismsStiff, OneTriangleOverTwoFrames) {
  test::Scratch scratch;
  FormulaSurface source({{0, 1, 2}}, countTo(2), [](std::size_t k) {
    return Points{bent(0, 0, k), bent(1, 0, k), bent(0, 1, k)};
  });
  const Built built = build(scratch, source, {});
  EXPECT_EQ(built.stats.tets, 3u);
  EXPECT_EQ(built.stats.vertices, 6u);
  EXPECT_EQ(built.stats.open_edges, 3u);
  EXPECT_GT(expectManifold(built.file), 0u) << "open in space";
}

TEST(PrismsStiff, OneFrameIsAnError) {
  FormulaSurface source({{0, 1, 2}}, {5.0}, [](std::size_t) { return Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}; });
  try {
    prisms::checkSource(source, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kBadInput);
    EXPECT_NE(error.fault().what.find("two at least"), std::string::npos);
  }
}

TEST(PrismsStiff, NoTrianglesAndImpossibleOptionsAreErrors) {
  FormulaSurface points({}, countTo(2), [](std::size_t) { return Points{{0, 0, 0}}; });
  EXPECT_THROW(prisms::checkSource(points, {}), Error);
  FormulaSurface source({{0, 1, 2}}, countTo(2), [](std::size_t) { return Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}; });
  EXPECT_THROW(prisms::checkSource(source, {.linear_tolerance = -1}), Error);
  EXPECT_THROW(prisms::checkSource(source, {.linear_tolerance = std::nan("")}), Error);
  EXPECT_THROW(prisms::checkSource(source, {.linear_window = 0}), Error);
  EXPECT_THROW(prisms::checkSource(source, {.linear_window = 64}), Error);
  EXPECT_NO_THROW(prisms::checkSource(source, {.linear_window = 63}));
}

TEST(PrismsStiff, ZeroAreaTrianglesKeepTheMeshConforming) {
  test::Scratch scratch;
  // A torus one ring of which has collapsed onto its neighbour, in some frames only.
  FormulaSurface source(torusTriangles(6, 5), countTo(7), [](std::size_t k) {
    Points points = torusPoints(6, 5);
    for (std::size_t v = 0; v < 5; ++v) {
      if (k % 3 != 2) points[v] = points[5 + v];
      points[10 + v][2] += std::sin(static_cast<double>(k));
    }
    return points;
  });
  const Built built = build(scratch, source, {});
  EXPECT_EQ(expectManifold(built.file), 0u);
  for (std::size_t k = 0; k < 7; ++k) EXPECT_LE(distanceAtFrame(built.file, source, k), 1e-6);
}

TEST(PrismsStiff, EdgesInThreeTrianglesAreTakenAndCounted) {
  test::Scratch scratch;
  FormulaSurface source({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, countTo(3), [](std::size_t k) {
    return Points{bent(0, 0, k), bent(1, 0, k), bent(0, 1, k), bent(0, -1, k), bent(1, 1, k)};
  });
  const Built built = build(scratch, source, {});
  EXPECT_EQ(built.stats.edges_over_two, 1u);
  EXPECT_EQ(built.stats.tets, 3u * 3 * 2);
  EXPECT_TRUE(built.file.verify().ok());
  outofcore::Progress progress;
  const auto faces = topology::checkHypermesh(built.file, progress);
  EXPECT_FALSE(faces.ok()) << "--validate tells of it";
  EXPECT_GT(faces.faces_over_two, 0u);
}

TEST(PrismsStiff, NeighboursWoundAlikeAreCounted) {
  FormulaSurface source({{0, 1, 2}, {0, 1, 3}}, countTo(2), [](std::size_t k) {
    return Points{bent(0, 0, k), bent(1, 0, k), bent(0, 1, k), bent(0, -1, k)};
  });
  test::Scratch scratch;
  EXPECT_EQ(build(scratch, source, {}).stats.misoriented_edges, 1u);
}

TEST(PrismsStiff, UnusedVerticesAreLeftOut) {
  test::Scratch scratch;
  FormulaSurface source({{1, 3, 5}}, countTo(4), [](std::size_t k) {
    return Points{{9, 9, 1e30}, bent(0, 0, k), {9, 9, 9}, bent(1, 0, k), {-9, 9, 9}, bent(0, 1, k), {-1e30, 9, 9}};
  });
  const Built built = build(scratch, source, {});
  EXPECT_EQ(built.stats.unused_vertices, 4u);
  EXPECT_EQ(built.stats.vertices, 12u);
  EXPECT_LE(built.file.header().bounds.max.x, 1);
  expectManifold(built.file);
}

TEST(PrismsStiff, AVertexThatNeverMovesIsKeptAtTheEndsOnly) {
  test::Scratch scratch;
  FormulaSurface source({{0, 1, 2}}, countTo(9), [](std::size_t k) {
    return Points{{0, 0, 0}, bent(1, 0, k), bent(0, 1, k)};
  });
  const Built built = build(scratch, source, {});
  // Its edges swing around it, and a diagonal to a moving vertex must not span a bend; still it moves less.
  EXPECT_LE(built.stats.vertices, 27u);
  EXPECT_LE(built.stats.error_measured, 1e-5);
  expectManifold(built.file);
  FormulaSurface still({{0, 1, 2}}, countTo(9), [](std::size_t) { return Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}; });
  EXPECT_EQ(build(scratch, still, {}).stats.vertices, 6u);
}

TEST(PrismsStiff, FarFromTheOriginAtEpochSecondsNothingIsLost) {
  test::Scratch scratch;
  std::vector<double> times;
  for (int k = 0; k < 5; ++k) times.push_back(1.7e9 + 1e-3 * k);
  const auto at = [](std::size_t k, double far) {
    Points points = torusPoints(6, 6);
    for (auto& p : points)
      p = {far + std::round(p[0] * 1024) / 1024, -2 * far + std::round(p[1] * 1024) / 1024,
           std::round(p[2] * 1024 * (1 + 0.5 * std::sin(static_cast<double>(k)))) / 1024};
    return points;
  };
  FormulaSurface far(torusTriangles(6, 6), times, [&](std::size_t k) { return at(k, 1e7); });
  const Built built = build(scratch, far, {});
  EXPECT_EQ(built.file.times()[3], times[3]);
  EXPECT_EQ(expectManifold(built.file), 0u);
  // The same vertices as near the origin, to the last bit.
  const SliceMesh slice = exchange::sliceHypermesh(built.file, 2);
  const Points expected = at(2, 1e7);
  const AffineMap& map = built.file.header().index_to_world;
  for (const Vec3f& p : slice.positions) {
    const auto world = toWorld(map, {p.x, p.y, p.z});
    EXPECT_NE(std::find(expected.begin(), expected.end(), world), expected.end());
  }
  EXPECT_EQ(slice.positions.size(), 36u);
}

TEST(PrismsStiff, TimeStepsOfANanosecondAndOfThirtyYears) {
  test::Scratch scratch;
  for (const double step : {1e-9, 1e9}) {
    const std::vector<double> times{0, step, 3 * step};
    FormulaSurface source(torusTriangles(4, 4), times, [](std::size_t k) {
      Points points = torusPoints(4, 4);
      for (auto& p : points) p[2] += std::sin(static_cast<double>(k * 2));
      return points;
    });
    const Built built = build(scratch, source, {});
    EXPECT_TRUE(std::equal(times.begin(), times.end(), built.file.times().begin()));
    EXPECT_EQ(expectManifold(built.file), 0u);
    EXPECT_EQ(distanceAtFrame(built.file, source, 1), 0);
  }
}

TEST(PrismsStiff, HugeAndTinyMeshes) {
  test::Scratch scratch;
  for (const double size : {1e30, 1e-30}) {
    FormulaSurface source(torusTriangles(5, 5), countTo(6), [=](std::size_t k) {
      Points points = torusPoints(5, 5);
      for (auto& p : points) {
        p[2] += p[0] * std::sin(static_cast<double>(k));
        for (double& c : p) c *= size;
      }
      return points;
    });
    const Built built = build(scratch, source, {});
    EXPECT_EQ(built.stats.tets, built.stats.tets_expanded) << size;
    EXPECT_EQ(expectManifold(built.file), 0u) << size;
  }
}

TEST(PrismsStiff, BeyondFloat32IsAnError) {
  test::Scratch scratch;
  FormulaSurface source({{0, 1, 2}}, countTo(2), [](std::size_t k) {
    return Points{{0, 0, 0}, {1, 0, 0}, {0, k == 0 ? 1.0 : 1e39, 0}};
  });
  try {
    build(scratch, source, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().place, "vertex 2");
  }
}

}  // namespace
}  // namespace tet4d::testing
