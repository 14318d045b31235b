// Stiff and extreme fields: what must still be a manifold, a valid empty file, or an error that says why.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/crossing.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::hypermesh {
namespace {

using testing::extract;
using testing::ExtractedMesh;
using testing::manifoldFaults;
using testing::MemoryFrames;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

MemoryFrames<float> constant(float value) {
  return {{4, 4, 4}, 3, [=](auto, auto, auto, auto) { return value; }};
}

TEST(Crossing, StaysInsideTheMargins) {
  EXPECT_EQ(crossingFraction(0, 1, 0.25), 0.25);
  EXPECT_EQ(crossingFraction(1, 0, 0.25), 0.75);
  EXPECT_EQ(crossingFraction(0.5, 0, 0.5), kCrossingMargin);
  EXPECT_EQ(crossingFraction(0, 0.5, 0.5), 1 - kCrossingMargin);
  EXPECT_EQ(crossingFraction(-kInf, 3, 1), 1 - kCrossingMargin);
  EXPECT_EQ(crossingFraction(3, -kInf, 1), kCrossingMargin);
  EXPECT_EQ(crossingFraction(0, kInf, 1), kCrossingMargin);
  EXPECT_EQ(crossingFraction(-kInf, kInf, 1), 0.5);
  EXPECT_EQ(crossingFraction(kNan, 2, 1), 1 - kCrossingMargin);
  EXPECT_EQ(crossingFraction(2, kNan, 1), kCrossingMargin);
  EXPECT_EQ(crossingFraction(kInf, kNan, 1), kCrossingMargin);
  EXPECT_DOUBLE_EQ(crossingFraction(-1.5e308, 1.5e308, 0), 0.5);
  EXPECT_DOUBLE_EQ(crossingFraction(1.5e308, -1.5e308, -0.75e308), 0.75);
  EXPECT_DOUBLE_EQ(crossingFraction(0, 4e-320, 1e-320), 0.25);
}

TEST(Crossing, IsStrictlyBetweenLatticePoints) {
  for (const std::int64_t index : {0L, 1L, 2047L, 4096L, 65535L, 2097151L, std::int64_t{kMaxIndex} - 1}) {
    for (const double fraction : {kCrossingMargin, 0.5, 1 - kCrossingMargin}) {
      const float at = strictlyBetween(index, fraction);
      EXPECT_GT(at, static_cast<float>(index));
      EXPECT_LT(at, static_cast<float>(index + 1));
    }
  }
}

TEST(MarchingStiff, ValueEqualToTheIsovalueEverywhereIsAllInside) {
  MemoryFrames<float> source = constant(0.5F);
  const ExtractedMesh mesh = extract(source, {.iso = 0.5});
  EXPECT_EQ(mesh.tets.size(), 0U);
  EXPECT_EQ(mesh.vertices.size(), 0U);
  EXPECT_EQ(mesh.pages.size(), 2U);
  EXPECT_EQ(mesh.header.frames, 3U);
}

TEST(MarchingStiff, ValueEqualToTheIsovalueOnAPlane) {
  MemoryFrames<float> source({5, 4, 4}, 3, [](auto x, auto, auto, auto) { return static_cast<float>(x) - 2; });
  const ExtractedMesh mesh = extract(source, {.iso = 0});
  for (const Vec4f& v : mesh.vertices) EXPECT_EQ(v.x, static_cast<float>(2 - kCrossingMargin));
  EXPECT_NEAR(threeVolume(mesh), 3 * 3 * 2, 1e-9);
  EXPECT_EQ(manifoldFaults(source, {.iso = 0}), "");
}

TEST(MarchingStiff, ValueEqualToTheIsovalueAtOneVertex) {
  MemoryFrames<float> source(
      {5, 5, 5}, 5, [](auto x, auto y, auto z, auto t) { return x == 2 && y == 2 && z == 2 && t == 2 ? 1.0F : 0.0F; });
  const ExtractedMesh mesh = extract(source, {.iso = 1});
  EXPECT_EQ(mesh.vertices.size(), 8U);
  EXPECT_EQ(mesh.tets.size(), 16U);
  EXPECT_GT(threeVolume(mesh), 0);
  EXPECT_EQ(manifoldFaults(source, {.iso = 1}), "");
}

TEST(MarchingStiff, IsovalueOutsideTheRangeIsAValidEmptyFile) {
  for (const double iso : {-3.0, 7.0, 1e300, -1e300}) {
    MemoryFrames<float> source({4, 4, 4}, 3, [](auto x, auto, auto, auto) { return static_cast<float>(x); });
    const ExtractedMesh mesh = extract(source, {.iso = iso});
    EXPECT_EQ(mesh.stats.tets + mesh.stats.vertices + mesh.stats.active_cells, 0U);
    EXPECT_EQ(mesh.stats.min_value, 0);
    EXPECT_EQ(mesh.stats.max_value, 3);
  }
}

TEST(MarchingStiff, ConstantFramesThatJumpGiveOneFlatSheet) {
  MemoryFrames<float> source({4, 4, 4}, 2, [](auto, auto, auto, auto t) { return t == 0 ? 1.0F : 0.0F; });
  const ExtractedMesh mesh = extract(source, {.iso = 0.25});
  for (const Vec4f& v : mesh.vertices) EXPECT_EQ(v.t, 0.75F);
  EXPECT_NEAR(threeVolume(mesh), 27, 1e-9);
}

TEST(MarchingStiff, FramesWithoutSurfaceAreEmptyPages) {
  MemoryFrames<float> source({4, 4, 4}, 7, [](auto x, auto, auto, auto t) { return t == 3 && x >= 2 ? 1.0F : 0.0F; });
  const ExtractedMesh mesh = extract(source, {.iso = 0.5});
  ASSERT_EQ(mesh.pages.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(mesh.pages[k][1] > 0, k == 2 || k == 3) << "slab " << k;
  EXPECT_EQ(manifoldFaults(source, {.iso = 0.5}), "");
}

Fault faultOf(exchange::FrameSource& source, const Options& options) {
  try {
    extract(source, options);
  } catch (const Error& error) {
    return error.fault();
  }
  return {FaultCode::kInterrupted, "", "", "nothing was thrown", ""};
}

TEST(MarchingStiff, OneFrameSaysThatTwoAreNeeded) {
  MemoryFrames<float> source({4, 4, 4}, 1, [](auto x, auto, auto, auto) { return static_cast<float>(x); });
  const Fault fault = faultOf(source, {.iso = 0.5});
  EXPECT_EQ(fault.code, FaultCode::kBadInput);
  EXPECT_NE(fault.what.find("two"), std::string::npos);
}

TEST(MarchingStiff, FlatGridsAreRefused) {
  for (const auto& dims : {std::array<std::uint64_t, 3>{1, 4, 4}, {4, 1, 4}, {4, 4, 1}}) {
    MemoryFrames<float> source(dims, 3, [](auto x, auto, auto, auto) { return static_cast<float>(x); });
    EXPECT_EQ(faultOf(source, {.iso = 0.5}).code, FaultCode::kBadInput);
  }
}

TEST(MarchingStiff, AnIsovalueThatIsNoNumberIsAUsageError) {
  MemoryFrames<float> source = constant(1);
  for (const float iso : {kNan, kInf, -kInf}) EXPECT_EQ(faultOf(source, {.iso = iso}).code, FaultCode::kUsage);
}

TEST(MarchingStiff, EveryConfigurationOfTheSmallestGrid) {
  for (unsigned configuration = 1; configuration < 65535; configuration += 1021) {
    MemoryFrames<float> source({2, 2, 2}, 2, [&](auto x, auto y, auto z, auto t) {
      return static_cast<float>(configuration >> (x + 2 * y + 4 * z + 8 * t) & 1U);
    });
    ASSERT_EQ(manifoldFaults(source, {.iso = 0.5}), "") << configuration;
  }
}

// One NaN in the middle of a ramp.
MemoryFrames<float> rampWithNan() {
  return {{6, 6, 6}, 6, [](auto x, auto y, auto z, auto t) {
            return x == 3 && y == 3 && z == 3 && t == 3 ? kNan : static_cast<float>(x) - 2.5F;
          }};
}

TEST(MarchingStiff, NanOutsideKeepsTheSurfaceClosed) {
  MemoryFrames<float> source = rampWithNan();
  const ExtractedMesh mesh = extract(source, {.iso = 0, .nan = NanRule::kOutside});
  EXPECT_EQ(mesh.stats.nan_samples, 1U);
  EXPECT_EQ(mesh.stats.masked_cells, 0U);
  EXPECT_EQ(mesh.header.flags, kOnGrid);
  EXPECT_EQ(manifoldFaults(source, {.iso = 0, .nan = NanRule::kOutside}), "");
  // The pocket around the NaN leaves its neighbours only by the margin.
  const auto near = [](float a, double b) { return a == static_cast<float>(b); };
  EXPECT_TRUE(std::any_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const Vec4f& v) {
    return v.y == 3 && v.z == 3 && v.t == 3 && near(v.x, 4 - kCrossingMargin);
  }));
}

TEST(MarchingStiff, NanMaskOpensTheSurfaceAndSaysSo) {
  MemoryFrames<float> source = rampWithNan();
  const ExtractedMesh mesh = extract(source, {.iso = 0, .nan = NanRule::kMask});
  EXPECT_EQ(mesh.stats.masked_cells, 16U);
  EXPECT_EQ(mesh.header.flags, kOnGrid | kInnerBoundary);
  EXPECT_EQ(manifoldFaults(source, {.iso = 0, .nan = NanRule::kMask}), "");
}

TEST(MarchingStiff, NanErrorNamesFrameAndSample) {
  MemoryFrames<float> source = rampWithNan();
  const Fault fault = faultOf(source, {.iso = 0, .nan = NanRule::kError});
  EXPECT_EQ(fault.code, FaultCode::kBadInput);
  EXPECT_EQ(fault.file, "memory frame 3");
  EXPECT_EQ(fault.place, "frame 3, sample 3 3 3");
}

TEST(MarchingStiff, MaskWithoutNanChangesNothing) {
  MemoryFrames<float> source({5, 5, 5}, 4,
                             [](auto x, auto y, auto, auto t) { return std::sin(static_cast<float>(x * y + t)); });
  const ExtractedMesh outside = extract(source, {.iso = 0.1}),
                      mask = extract(source, {.iso = 0.1, .nan = NanRule::kMask});
  EXPECT_EQ(outside.bytes, mask.bytes);
}

TEST(MarchingStiff, AllNanIsEmpty) {
  for (const NanRule rule : {NanRule::kOutside, NanRule::kMask}) {
    MemoryFrames<float> source = constant(kNan);
    const ExtractedMesh mesh = extract(source, {.iso = 0.5, .nan = rule});
    EXPECT_EQ(mesh.tets.size() + mesh.vertices.size(), 0U);
    EXPECT_GT(mesh.stats.min_value, mesh.stats.max_value);
  }
}

TEST(MarchingStiff, InfinitiesMixedWithNumbers) {
  std::mt19937 random(5);
  const std::array<float, 6> values{-kInf, kInf, -1, 0, 1, 1e38F};
  MemoryFrames<float> source({6, 6, 6}, 5, [&](auto, auto, auto, auto) { return values[random() % 6]; });
  for (const NanRule rule : {NanRule::kOutside, NanRule::kMask, NanRule::kError}) {
    EXPECT_EQ(manifoldFaults(source, {.iso = 0.5, .nan = rule}), "");
  }
}

TEST(MarchingStiff, InfinitiesAndNansUnderEveryRule) {
  std::mt19937 random(6);
  const std::array<float, 7> values{-kInf, kInf, -1, 0, 1, 2, kNan};
  MemoryFrames<float> source({6, 6, 6}, 5, [&](auto, auto, auto, auto) { return values[random() % 7]; });
  EXPECT_EQ(manifoldFaults(source, {.iso = 0.5, .nan = NanRule::kOutside}), "");
  EXPECT_FALSE(extract(source, {.iso = 0.5, .nan = NanRule::kOutside}).tets.empty());
  EXPECT_EQ(faultOf(source, {.iso = 0.5, .nan = NanRule::kError}).code, FaultCode::kBadInput);
}

TEST(MarchingStiff, DenormalsAndHugeValuesScaleExactly) {
  // Multiplying field and isovalue by a power of two changes no vertex, as long as nothing is rounded.
  const auto field = [](double scale) {
    return MemoryFrames<double>({6, 6, 6}, 4, [=](auto x, auto y, auto z, auto t) {
      return scale * static_cast<double>((7 * x + 3 * y * y + 5 * z + 11 * t * x) % 17);
    });
  };
  MemoryFrames<double> plain = field(1), tiny = field(0x1p-1070), huge = field(0x1p1019);
  const ExtractedMesh expected = extract(plain, {.iso = 8});
  ASSERT_FALSE(expected.tets.empty());
  EXPECT_EQ(extract(tiny, {.iso = 0x1p-1067}).vertices, expected.vertices);
  EXPECT_EQ(extract(huge, {.iso = 0x1p1022}).vertices, expected.vertices);
}

TEST(MarchingStiff, FloatsNearTheirLimits) {
  std::mt19937 random(8);
  for (const float scale : {1e38F, 1e-44F}) {
    MemoryFrames<float> source({5, 5, 5}, 4, [&](auto, auto, auto, auto) {
      return scale * static_cast<float>(static_cast<int>(random() % 7) - 3);
    });
    EXPECT_EQ(manifoldFaults(source, {.iso = 0.5 * double{scale}}), "");
  }
}

// The isovalue lies between two floats: comparing its rounding instead would put the sample on the wrong side.
TEST(MarchingStiff, TheIsovalueIsNotRoundedToTheSampleType) {
  const double iso = 0.1;  // below float(0.1)
  ASSERT_LT(iso, double{0.1F});
  MemoryFrames<float> inside = constant(0.1F), outside = constant(std::nextafter(0.1F, 0.0F));
  ASSERT_LT(double{outside.at(0, 0, 0, 0)}, iso);
  MemoryFrames<float> step({3, 3, 3}, 2,
                           [&](auto x, auto, auto, auto) { return x == 0 ? std::nextafter(0.1F, 0.0F) : 0.1F; });
  EXPECT_EQ(extract(inside, {.iso = iso}).tets.size(), 0U);
  EXPECT_EQ(extract(outside, {.iso = iso}).tets.size(), 0U);
  EXPECT_GT(extract(step, {.iso = iso}).tets.size(), 0U);
  EXPECT_EQ(extract(step, {.iso = double{0.1F} + 1e-12}).tets.size(), 0U);
}

TEST(MarchingStiff, StepsOfBytesAreAManifold) {
  MemoryFrames<std::uint8_t> source({7, 7, 7}, 5, [](auto x, auto y, auto z, auto t) {
    return static_cast<std::uint8_t>(x + y + z + t > 12 ? 255 : x * y * z * t % 3);
  });
  for (const double iso : {0.5, 1.0, 2.0, 128.0, 255.0}) EXPECT_EQ(manifoldFaults(source, {.iso = iso}), "") << iso;
}

TEST(MarchingStiff, FarFramesKeepTheirVerticesApart) {
  // 5000 frames: the f32 step there is 2^-11, coarser than the margin.
  MemoryFrames<std::uint8_t> source({2, 2, 2}, 5000, [](auto x, auto, auto, auto t) {
    return static_cast<std::uint8_t>(t > 4990 && (x + t) % 2 ? 1 : 0);
  });
  const ExtractedMesh mesh = extract(source, {.iso = 1});
  std::size_t between = 0;
  for (const Vec4f& v : mesh.vertices) between += v.t != std::floor(v.t);
  EXPECT_GT(between, 0U);
  std::size_t flat = 0;
  for (const Vec4f& v : mesh.vertices) flat += v.t == std::floor(v.t) && v.x == std::floor(v.x);
  EXPECT_EQ(flat, 0U);
}

}  // namespace
}  // namespace tet4d::hypermesh
