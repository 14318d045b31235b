// Signs and crossings of every sample type, in both sets of instructions, against plain loops.
#include "libpreprocess/hypermesh/sample_kernels.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "libpreprocess/hypermesh/crossing.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::hypermesh {
namespace {

template <class T>
class EveryType : public ::testing::Test {};
using SampleTypes = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(EveryType, SampleTypes);

// Samples of a row: all bit patterns of the type, which among floats are NaNs, infinities and denormals too.
template <class T>
std::vector<T> anyBits(std::size_t count, std::mt19937_64& random) {
  std::vector<T> samples(count);
  for (T& sample : samples) {
    const std::uint64_t bits = random();
    std::memcpy(&sample, &bits, sizeof sample);
  }
  return samples;
}

template <class T>
std::vector<double> isovaluesFor() {
  using Limits = std::numeric_limits<T>;
  return {0.0,
          0.5,
          -0.0,
          17.0,
          17.000001,
          static_cast<double>(Limits::max()),
          static_cast<double>(Limits::lowest()),
          std::nextafter(static_cast<double>(Limits::max()), 1e300),
          std::nextafter(static_cast<double>(Limits::lowest()), 0.0),
          1e300,
          -1e300,
          5e-324};
}

// Compared exactly: long double holds every sample and every isovalue.
template <class T>
bool isInside(T sample, double iso) {
  return static_cast<long double>(sample) >= static_cast<long double>(iso);
}

TYPED_TEST(EveryType, SignsAreExactComparisons) {
  std::mt19937_64 random(7);
  const std::vector<double> isovalues = isovaluesFor<TypeParam>();
  for (const Simd simd : {Simd::kPortable, Simd::kWide}) {
    if (simd == Simd::kWide && bestSimd() != Simd::kWide) GTEST_SKIP() << "this machine has the portable loops only";
    const auto kernels = makeSampleKernels(testing::sampleTypeOf<TypeParam>(), isovalues, simd);
    for (const std::size_t count : {1U, 2U, 63U, 64U, 65U, 128U, 200U}) {
      std::vector<TypeParam> samples = anyBits<TypeParam>(count, random);
      for (std::size_t i = 0; i < count; i += 5) samples[i] = 17;
      const std::size_t words = (count + 63) / 64;
      std::vector<std::vector<std::uint64_t>> signs(isovalues.size(), std::vector<std::uint64_t>(words, ~0ULL));
      std::vector<std::uint64_t*> rows;
      for (auto& row : signs) rows.push_back(row.data());
      std::vector<RowState> states(isovalues.size());
      std::vector<std::uint64_t> nans(words, ~0ULL);
      SampleRange range;
      kernels->classifyRow(reinterpret_cast<const std::byte*>(samples.data()), count, rows, states.data(), nans.data(),
                           range);
      std::uint64_t nan_count = 0;
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (std::size_t i = 0; i < count; ++i) {
        const bool nan = samples[i] != samples[i];
        nan_count += nan;
        if (!nan) least = std::min(least, static_cast<double>(samples[i]));
        if (!nan) most = std::max(most, static_cast<double>(samples[i]));
        ASSERT_EQ(nans[i / 64] >> i % 64 & 1U, nan);
        for (std::size_t v = 0; v < isovalues.size(); ++v)
          ASSERT_EQ(signs[v][i / 64] >> i % 64 & 1U, isInside(samples[i], isovalues[v]))
              << "sample " << +samples[i] << ", isovalue " << isovalues[v];
      }
      EXPECT_EQ(range.nan_samples, nan_count);
      EXPECT_EQ(range.min, least);
      EXPECT_EQ(range.max, most);
      for (std::size_t v = 0; v < isovalues.size(); ++v) {
        std::size_t inside = 0;
        for (const std::uint64_t word : signs[v]) inside += static_cast<std::size_t>(std::popcount(word));
        EXPECT_EQ(states[v], inside == 0 ? RowState::kOutside : inside == count ? RowState::kInside : RowState::kMixed);
      }
    }
  }
}

TYPED_TEST(EveryType, VerticesStandAtTheLinearCrossing) {
  const std::vector<TypeParam> lower{0, 100, 3, 0, 50}, upper{100, 0, 4, 1, 51};
  const std::vector<double> isovalues{25.0, 3.25, 0.5, 50.75};
  const auto kernels = makeSampleKernels(testing::sampleTypeOf<TypeParam>(), isovalues);
  const auto* from = reinterpret_cast<const std::byte*>(lower.data());
  const auto* to = reinterpret_cast<const std::byte*>(upper.data());
  for (std::size_t v = 0; v < isovalues.size(); ++v) {
    std::uint64_t bits = 0;
    std::vector<float> expected;
    for (std::size_t i = 0; i < lower.size(); ++i) {
      if (isInside(lower[i], isovalues[v]) == isInside(upper[i], isovalues[v])) continue;
      bits |= 1ULL << i;
      const double at = (isovalues[v] - static_cast<double>(lower[i])) /
                        (static_cast<double>(upper[i]) - static_cast<double>(lower[i]));
      expected.push_back(static_cast<float>(1000 + std::clamp(at, kCrossingMargin, 1 - kCrossingMargin)));
    }
    std::vector<Vec4f> out(expected.size());
    const Vec4f* end = kernels->placeRow({{&bits, 1}, 0, 0, 8, 5, 6, 1000}, from, to, v, out.data());
    ASSERT_EQ(end, out.data() + out.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      EXPECT_EQ(out[i].t, expected[i]);
      EXPECT_EQ(out[i].y, 5);
      EXPECT_EQ(out[i].z, 6);
    }
  }
}

}  // namespace
}  // namespace tet4d::hypermesh
