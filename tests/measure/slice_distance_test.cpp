// Slices of tetrahedra against one another, at frames and between them: sheets whose distance is known.
#include "libpreprocess/measure/slice_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace tet4d::measure {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Mesh {
  std::vector<Vec4f> positions;
  std::vector<hypermesh::Tet> tets;
};

// A square sheet that moves along its normal: heights at times 0, 1, …, straight between them. Prisms of three
// tetrahedra each, split from the lowest corner so that neighbours agree.
Mesh sheet(const std::vector<float>& heights) {
  Mesh mesh;
  for (std::size_t k = 0; k < heights.size(); ++k) {
    for (const auto& [x, y] : {std::pair{0.0F, 0.0F}, {4.0F, 0.0F}, {4.0F, 4.0F}, {0.0F, 4.0F}})
      mesh.positions.push_back({x, y, heights[k], static_cast<float>(k)});
  }
  for (std::uint32_t k = 0; k + 1 < heights.size(); ++k) {
    for (const std::array<std::uint32_t, 3> t : {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 2, 3}}) {
      std::array<std::uint32_t, 3> a{}, b{};
      for (std::size_t c = 0; c < 3; ++c) a[c] = 4 * k + t[c], b[c] = 4 * k + 4 + t[c];
      mesh.tets.push_back({a[0], a[1], a[2], b[2]});
      mesh.tets.push_back({a[0], a[1], b[1], b[2]});
      mesh.tets.push_back({a[0], b[0], b[1], b[2]});
    }
  }
  return mesh;
}

SplitDistance judged(const Mesh& mesh, const Mesh& reference, const SliceTimes& times, const SliceFrame& where = {}) {
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  SliceJudge judge(slicesOf(reference.positions, reference.tets, 4), times, where, {1e-6, 1000, 100'000});
  return judge.judge(slicesOf(mesh.positions, mesh.tets, 4), executor, progress);
}

TEST(SliceJudge, FramesAndTimesBetweenAreTold) {
  // Off at frame 2 alone: half of it halfway, nothing at frames 1 and 3.
  const SplitDistance d = judged(sheet({0, 0, 0.5, 0, 0}), sheet({0, 0, 0, 0, 0}), {{1, 2, 3}, {0.37, 1.37, 2.37}});
  ASSERT_EQ(d.at.slices.size(), 3U);
  EXPECT_NEAR(d.at.max, 0.5, 1e-5);
  EXPECT_NEAR(d.at.rms, 0.5 / 3, 1e-5) << "the mean over the times";
  EXPECT_NEAR(d.at.slices[1].rms, 0.5, 1e-5);
  EXPECT_NEAR(d.at.slices[2].max, 0, 1e-6);
  EXPECT_NEAR(d.between.slices[0].max, 0, 1e-6);
  EXPECT_NEAR(d.between.slices[1].max, 0.5 * 0.37, 1e-5);
  EXPECT_NEAR(d.between.max, 0.5 * 0.63, 1e-5);
  EXPECT_NEAR(d.between.p99, 0.5 * 0.63, 1e-5);
  EXPECT_EQ(d.at.volume_error, 0) << "sheets enclose nothing";
  EXPECT_EQ(d.at.slices[0].volume_reference, 0);
}

TEST(SliceJudge, LengthsAreThoseOfTheMap) {
  AffineMap map;
  map.origin = {1e9, 0, 0};
  map.axes = {{{2, 0, 0}, {0, 2, 0}, {0, 0, 1000}}};
  const SplitDistance d = judged(sheet({0, 0.25F, 0, 0, 0}), sheet({0, 0, 0, 0, 0}), {{1}, {}}, {map, {0, 0, 0}});
  EXPECT_NEAR(d.at.max, 250, 1e-3);
  EXPECT_TRUE(d.between.slices.empty());
}

TEST(SliceJudge, WhatIsMissingIsInfinitelyFar) {
  Mesh cut = sheet({0, 0, 0, 0, 0});
  cut.tets.resize(6);  // the first interval only
  const SplitDistance d = judged(cut, sheet({0, 0, 0, 0, 0}), {{}, {0.5, 2.5}});
  EXPECT_NEAR(d.between.slices[0].max, 0, 1e-6);
  EXPECT_EQ(d.between.max, kInfinity);
}

TEST(SampleTimes, AreInnerAndAscend) {
  const auto times = [](float first, float last, std::size_t count) {
    return sampleTimes({{0, 0, 0, first}, {1, 1, 1, last}}, count);
  };
  for (const float last : {1.0F, 2.0F, 3.0F, 8.0F, 100.0F}) {
    for (const std::size_t count : {1U, 2U, 4U, 7U}) {
      const SliceTimes t = times(0, last, count);
      EXPECT_LE(t.at.size(), count);
      ASSERT_FALSE(t.between.empty());
      EXPECT_EQ(t.at.empty(), last == 1) << "one interval has no inner frame";
      for (std::size_t i = 0; i < t.at.size(); ++i) {
        EXPECT_EQ(t.at[i], std::round(t.at[i]));
        EXPECT_TRUE(t.at[i] > 0 && t.at[i] < double{last} && (i == 0 || t.at[i] > t.at[i - 1]));
      }
      for (std::size_t i = 0; i < t.between.size(); ++i) {
        EXPECT_NEAR(t.between[i] - std::floor(t.between[i]), 0.37, 1e-9);
        EXPECT_TRUE(t.between[i] > 0 && t.between[i] < double{last} && (i == 0 || t.between[i] > t.between[i - 1]));
      }
    }
  }
  EXPECT_EQ(times(0, 100, 4).at.size(), 4U);
}

}  // namespace
}  // namespace tet4d::measure
