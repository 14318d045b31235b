#include "libpreprocess/hypermesh/sample_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <vector>

#include "libpreprocess/hypermesh/crossing.h"

namespace tet4d::hypermesh {
namespace {

constexpr std::size_t kBlock = 64;  // samples a word of signs

template <class T>
constexpr T kLowest = std::is_floating_point_v<T> ? -std::numeric_limits<T>::infinity() : std::numeric_limits<T>::min();
template <class T>
constexpr T kHighest = std::is_floating_point_v<T> ? std::numeric_limits<T>::infinity() : std::numeric_limits<T>::max();

// The smallest T that is >= iso, so that comparing in T decides as comparing exact numbers would.
template <class T>
struct Threshold {
  T least = 0;
  bool none = false;  // no T is >= iso
};

template <class T>
Threshold<T> thresholdOf(double iso) {
  if constexpr (std::is_floating_point_v<T>) {
    const T rounded = static_cast<T>(iso);
    const bool below = static_cast<double>(rounded) < iso;
    return {below ? std::nextafter(rounded, std::numeric_limits<T>::infinity()) : rounded, false};
  } else {
    const double least = std::ceil(iso);
    // The first double above every T: 2^digits.
    if (least >= std::ldexp(1.0, std::numeric_limits<T>::digits)) return {0, true};
    if (least <= static_cast<double>(std::numeric_limits<T>::min())) return {std::numeric_limits<T>::min(), false};
    return {static_cast<T>(least), false};
  }
}

// Eight bytes of 0 or 1 to eight bits.
[[gnu::always_inline]] inline std::uint64_t gatherBits(const std::uint8_t* flags) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, flags, sizeof bytes);
  return bytes * 0x0102040810204080U >> 56;
}

template <class T>
[[gnu::always_inline]] inline std::uint64_t signsOf(const T* samples, T least) {
  std::array<std::uint8_t, kBlock> flags;
  for (std::size_t i = 0; i < kBlock; ++i) flags[i] = samples[i] >= least;
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < kBlock; i += 8) word |= gatherBits(&flags[i]) << i;
  return word;
}

template <class T>
[[gnu::always_inline]] inline std::uint64_t nansOf(const T* samples) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < kBlock; ++i) word |= static_cast<std::uint64_t>(samples[i] != samples[i]) << i;
  return word;
}

// Least and greatest of 64 samples, NaNs passed over, and whether there are any.
template <class T>
struct BlockRange {
  T least, greatest;
  bool nan;
};

template <class T>
[[gnu::always_inline]] inline BlockRange<T> rangeOf(const T* samples) {
  constexpr std::size_t kLanes = 64 / sizeof(T) < 16 ? 16 : 64 / sizeof(T);
  using Flag = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
  std::array<T, kLanes> least, greatest;
  least.fill(kHighest<T>);
  greatest.fill(kLowest<T>);
  std::array<Flag, kLanes> nan{};
  for (std::size_t i = 0; i < kBlock; i += kLanes) {
    for (std::size_t j = 0; j < kLanes; ++j) {
      const T v = samples[i + j];
      least[j] = v < least[j] ? v : least[j];
      greatest[j] = v > greatest[j] ? v : greatest[j];
      if constexpr (std::is_floating_point_v<T>) nan[j] |= v != v ? Flag{-1} : Flag{0};
    }
  }
  BlockRange<T> range{least[0], greatest[0], nan[0] != 0};
  for (std::size_t j = 1; j < kLanes; ++j) {
    range.least = std::min(range.least, least[j]);
    range.greatest = std::max(range.greatest, greatest[j]);
    range.nan |= nan[j] != 0;
  }
  return range;
}

template <class T>
struct RowTask {
  const T* samples;
  std::size_t count;
  std::span<const Threshold<T>> thresholds;
  std::span<std::uint64_t* const> signs;
  RowState* states;
  std::uint64_t* nans;
};

// What a row had.
template <class T>
struct RowSeen {
  T least = kHighest<T>, greatest = kLowest<T>;
  std::uint64_t nans = 0;
};

template <class T>
[[gnu::always_inline]] inline RowSeen<T> classifyRowImpl(const RowTask<T>& task) {
  RowSeen<T> seen;
  const std::size_t parts = task.thresholds.size();
  std::array<T, kBlock> rest;  // the last block, filled up with its first sample
  for (std::size_t w = 0; w * kBlock < task.count; ++w) {
    const T* block = task.samples + w * kBlock;
    const std::size_t count = std::min(kBlock, task.count - w * kBlock);
    std::uint64_t valid = ~std::uint64_t{0};
    if (count < kBlock) {
      rest.fill(block[0]);
      std::copy(block, block + count, rest.begin());
      block = rest.data();
      valid = (std::uint64_t{1} << count) - 1;
    }
    const BlockRange<T> range = rangeOf(block);
    seen.least = std::min(seen.least, range.least);
    seen.greatest = std::max(seen.greatest, range.greatest);
    std::uint64_t nans = 0;
    if constexpr (std::is_floating_point_v<T>) {
      if (range.nan) {
        nans = nansOf(block) & valid;
        seen.nans += static_cast<std::uint64_t>(std::popcount(nans));
      }
    }
    if (task.nans != nullptr) task.nans[w] = nans;
    for (std::size_t i = 0; i < parts; ++i) {
      const Threshold<T>& threshold = task.thresholds[i];
      std::uint64_t word = 0;
      if (!threshold.none && range.greatest >= threshold.least) {
        word = range.least >= threshold.least && nans == 0 ? valid : signsOf(block, threshold.least) & valid;
      }
      task.signs[i][w] = word;
      const RowState state = word == 0 ? RowState::kOutside : word == valid ? RowState::kInside : RowState::kMixed;
      task.states[i] = w == 0 || task.states[i] == state ? state : RowState::kMixed;
    }
  }
  return seen;
}

template <class T>
RowSeen<T> classifyRowPortable(const RowTask<T>& task) {
  return classifyRowImpl(task);
}
template <class T>
TET4D_WIDE RowSeen<T> classifyRowWide(const RowTask<T>& task) {
  return classifyRowImpl(task);
}

template <class T>
class TypedKernels final : public SampleKernels {
 public:
  TypedKernels(std::span<const double> isovalues, Simd simd)
      : isovalues_(isovalues.begin(), isovalues.end()),
        classify_(simd == Simd::kWide ? classifyRowWide<T> : classifyRowPortable<T>) {
    for (const double iso : isovalues) thresholds_.push_back(thresholdOf<T>(iso));
  }

  bool classifyRow(const std::byte* samples, std::size_t count, std::span<std::uint64_t* const> signs, RowState* states,
                   std::uint64_t* nans, SampleRange& range) const override {
    const RowSeen<T> seen = classify_({typed(samples), count, thresholds_, signs, states, nans});
    if (seen.nans < count) {
      range.add({static_cast<double>(seen.least), static_cast<double>(seen.greatest), seen.nans});
    } else {
      range.nan_samples += seen.nans;
    }
    return seen.nans != 0;
  }

  Vec4f* placeRow(const EdgeRowPlace& row, const std::byte* lower, const std::byte* upper, std::size_t isovalue,
                  Vec4f* out) const override {
    const T* const from = typed(lower) + row.lower;
    const T* const to = typed(upper) + row.upper;
    const double iso = isovalues_[isovalue];
    const auto along = [&](unsigned axis, std::uint64_t index, double fraction) {
      return (row.axes >> axis & 1U) != 0 ? strictlyBetween(static_cast<std::int64_t>(index), fraction)
                                          : static_cast<float>(index);
    };
    for (std::size_t w = 0; w < row.bits.size(); ++w) {
      for (std::uint64_t rest = row.bits[w]; rest != 0; rest &= rest - 1) {
        const std::uint64_t x = w * kBlock + static_cast<std::uint64_t>(std::countr_zero(rest));
        const double fraction = crossingFraction(static_cast<double>(from[x]), static_cast<double>(to[x]), iso);
        *out++ = {along(0, x, fraction), along(1, row.y, fraction), along(2, row.z, fraction),
                  along(3, row.frame, fraction)};
      }
    }
    return out;
  }

  double isovalue(std::size_t i) const override { return isovalues_[i]; }

  double value(const std::byte* samples, std::size_t i) const override {
    return static_cast<double>(typed(samples)[i]);
  }

 private:
  static const T* typed(const std::byte* samples) {
    assert(reinterpret_cast<std::uintptr_t>(samples) % alignof(T) == 0);
    return reinterpret_cast<const T*>(samples);
  }
  std::vector<double> isovalues_;
  std::vector<Threshold<T>> thresholds_;
  RowSeen<T> (*classify_)(const RowTask<T>&);
};

}  // namespace

void SampleRange::add(const SampleRange& other) {
  min = std::min(min, other.min);
  max = std::max(max, other.max);
  nan_samples += other.nan_samples;
}

std::unique_ptr<SampleKernels> makeSampleKernels(SampleType type, std::span<const double> isovalues, Simd simd) {
  const auto make = [&]<class T>(T) -> std::unique_ptr<SampleKernels> {
    return std::make_unique<TypedKernels<T>>(isovalues, simd);
  };
  switch (type) {
    case SampleType::kU8:
      return make(std::uint8_t{});
    case SampleType::kI8:
      return make(std::int8_t{});
    case SampleType::kU16:
      return make(std::uint16_t{});
    case SampleType::kI16:
      return make(std::int16_t{});
    case SampleType::kU32:
      return make(std::uint32_t{});
    case SampleType::kI32:
      return make(std::int32_t{});
    case SampleType::kU64:
      return make(std::uint64_t{});
    case SampleType::kI64:
      return make(std::int64_t{});
    case SampleType::kF32:
      return make(float{});
    case SampleType::kF64:
      return make(double{});
  }
  return nullptr;
}

}  // namespace tet4d::hypermesh
