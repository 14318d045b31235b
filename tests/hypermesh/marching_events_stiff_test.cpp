// Stiff cases of what happens in time and at the walls: births, merges, splits and deaths inside one step, noise,
// walls, times far apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/core/coordinates.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::hypermesh {
namespace {

using testing::extract;
using testing::ExtractedMesh;
using testing::manifoldFaults;
using testing::MemoryFrames;

struct Ball {
  double x, y, z, radius;
};

// The union of balls, frame by frame.
MemoryFrames<float> ballsPerFrame(std::vector<std::vector<Ball>> frames) {
  return {{16, 10, 10}, frames.size(), [=](auto x, auto y, auto z, auto k) {
            double value = -10;
            for (const Ball& ball : frames[k]) {
              value = std::max(
                  value, ball.radius - std::hypot(static_cast<double>(x) - ball.x, static_cast<double>(y) - ball.y,
                                                  static_cast<double>(z) - ball.z));
            }
            return static_cast<float>(value);
          }};
}

constexpr Ball kLeft{4.2, 4.6, 4.4, 2.7}, kRight{11.3, 4.5, 4.6, 2.8}, kBoth{7.6, 4.5, 4.5, 3.4};

TEST(MarchingEventsStiff, BirthAndDeathInsideOneStepIsAClosedSurface) {
  // Nothing in the first and last frame: a hypermesh without any boundary.
  MemoryFrames<float> source = ballsPerFrame({{}, {kLeft}, {}});
  EXPECT_EQ(manifoldFaults(source, {.iso = 0}), "");
  const ExtractedMesh mesh = extract(source, {.iso = 0});
  for (const Vec4f& v : mesh.vertices) {
    EXPECT_GT(v.t, 0);
    EXPECT_LT(v.t, 2);
  }
  EXPECT_GT(testing::enclosedFourVolume(mesh), 0);
}

TEST(MarchingEventsStiff, MergesAndSplitsInsideOneStep) {
  for (const auto& frames : {std::vector<std::vector<Ball>>{{kLeft, kRight}, {kBoth}},
                             {{kBoth}, {kLeft, kRight}},
                             {{kLeft}, {kRight}},  // one dies where another is born
                             {{kLeft, kRight}, {kBoth}, {kLeft}, {}, {kRight, kBoth}}}) {
    MemoryFrames<float> source = ballsPerFrame(frames);
    for (const Split split : {Split::kHull, Split::kKuhn})
      EXPECT_EQ(manifoldFaults(source, {.iso = 0, .split = split}), "");
  }
}

TEST(MarchingEventsStiff, WhiteNoiseStaysBelowTheWorstCell) {
  std::mt19937 random(3);
  MemoryFrames<std::uint8_t> source({12, 11, 10}, 5,
                                    [&](auto, auto, auto, auto) { return static_cast<std::uint8_t>(random() >> 24); });
  const ExtractedMesh mesh = extract(source, {.iso = 127.5});
  const std::uint64_t cells = std::uint64_t{11} * 10 * 9 * 4;
  EXPECT_LE(mesh.tets.size(), 24 * cells);
  EXPECT_NEAR(static_cast<double>(mesh.tets.size()) / static_cast<double>(cells), 13.0, 0.5);  // the table's mean
  EXPECT_EQ(manifoldFaults(source, {.iso = 127.5}), "");
}

TEST(MarchingEventsStiff, SurfacesAlongTheWalls) {
  const std::array<std::uint64_t, 3> dims{7, 6, 5};
  // The outermost layer inside, or all but it; the far walls only.
  const auto onWall = [=](auto x, auto y, auto z) {
    return x == 0 || y == 0 || z == 0 || x == dims[0] - 1 || y == dims[1] - 1 || z == dims[2] - 1;
  };
  const auto onFarWall = [=](auto x, auto y, auto z) {
    return x == dims[0] - 1 || y == dims[1] - 1 || z == dims[2] - 1;
  };
  MemoryFrames<float> shell(dims, 3, [=](auto x, auto y, auto z, auto) { return onWall(x, y, z) ? 1.0F : 0.0F; });
  MemoryFrames<float> core(dims, 3, [=](auto x, auto y, auto z, auto) { return onWall(x, y, z) ? 0.0F : 1.0F; });
  MemoryFrames<float> far(dims, 3, [=](auto x, auto y, auto z, auto) { return onFarWall(x, y, z) ? 1.0F : 0.0F; });
  for (MemoryFrames<float>* source : {&shell, &core, &far}) {
    for (const std::uint64_t pad : {0U, 1U}) {
      EXPECT_EQ(manifoldFaults(*source, {.iso = 0.5, .pad = pad}), "");
      EXPECT_FALSE(extract(*source, {.iso = 0.5, .pad = pad}).tets.empty());
    }
  }
}

// Times stand in a float64 table beside float32 frame numbers: neither their size nor their steps cost a bit.
TEST(MarchingEventsStiff, TimesFarApartKeepEveryBit) {
  const std::vector<std::vector<double>> sequences{{0, 1e-9, 2e-9, 5e-9},
                                                   {0, 1e9, 3e9, 4e9},
                                                   {1.7e9, 1.7e9 + 1e-6, 1.7e9 + 1, 1.7e9 + 1e5},
                                                   {-1e9, -1e-9, 1e-9, 1e9}};
  MemoryFrames<float> source = ballsPerFrame({{kLeft}, {kBoth}, {kRight}, {kLeft}});
  const ExtractedMesh plain = extract(source, {.iso = 0});
  for (const std::vector<double>& times : sequences) {
    source.times(times);
    const ExtractedMesh mesh = extract(source, {.iso = 0});
    EXPECT_EQ(mesh.vertices, plain.vertices);
    EXPECT_EQ(mesh.tets, plain.tets);
    for (std::size_t k = 0; k < times.size(); ++k) {
      EXPECT_EQ(timeOfFrame(mesh.times, static_cast<double>(k)), times[k]);
      EXPECT_EQ(frameOfTime(mesh.times, times[k]), static_cast<double>(k));
    }
  }
}

TEST(MarchingEventsStiff, SpacingsFarApartKeepTheMesh) {
  MemoryFrames<float> source = ballsPerFrame({{kLeft}, {kBoth}, {kRight}});
  const ExtractedMesh plain = extract(source, {.iso = 0});
  source.map({{1e7, -1e7, 1e7}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1000}}}});
  const ExtractedMesh stretched = extract(source, {.iso = 0});
  EXPECT_EQ(stretched.vertices, plain.vertices);
  EXPECT_EQ(stretched.tets, plain.tets);
  EXPECT_EQ(toWorld(stretched.header.index_to_world, {1, 2, 3}),
            (std::array<double, 3>{1e7 + 1, -1e7 + 2, 1e7 + 3000}));
}

}  // namespace
}  // namespace tet4d::hypermesh
