#include "libpreprocess/hypermesh/frame_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "formats/container.h"

namespace tet4d::hypermesh {
namespace {

template <class T>
constexpr SampleType kOwnType = sizeof(T) == 4 ? SampleType::kF32 : SampleType::kF64;

template <class From, class To>
void convert(std::span<const std::byte> raw, std::span<To> samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    From value;
    std::memcpy(&value, raw.data() + i * sizeof(From), sizeof(From));
    samples[i] = static_cast<To>(value);
  }
}

template <class To>
void convert(SampleType type, std::span<const std::byte> raw, std::span<To> samples) {
  switch (type) {
    case SampleType::kU8:
      return convert<std::uint8_t>(raw, samples);
    case SampleType::kI8:
      return convert<std::int8_t>(raw, samples);
    case SampleType::kU16:
      return convert<std::uint16_t>(raw, samples);
    case SampleType::kI16:
      return convert<std::int16_t>(raw, samples);
    case SampleType::kU32:
      return convert<std::uint32_t>(raw, samples);
    case SampleType::kI32:
      return convert<std::int32_t>(raw, samples);
    case SampleType::kU64:
      return convert<std::uint64_t>(raw, samples);
    case SampleType::kI64:
      return convert<std::int64_t>(raw, samples);
    case SampleType::kF32:
      return convert<float>(raw, samples);
    case SampleType::kF64:
      return convert<double>(raw, samples);
  }
}

// The smallest T that is >= iso, so that comparing in T decides as comparing in double would.
template <class T>
T thresholdOf(double iso) {
  const T threshold = static_cast<T>(iso);
  return static_cast<double>(threshold) < iso ? std::nextafter(threshold, std::numeric_limits<T>::infinity())
                                              : threshold;
}

template <class T>
struct LayerRange {
  T min = std::numeric_limits<T>::infinity(), max = -std::numeric_limits<T>::infinity();
  std::uint64_t nans = 0;
};

// Up to 64 samples into one word of signs; returns the word of NaNs.
template <class T>
std::uint64_t classifyWord(const T* samples, std::size_t count, T threshold, std::uint64_t& inside,
                           LayerRange<T>& range) {
  std::uint64_t signs = 0, nans = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const T value = samples[i];
    signs |= static_cast<std::uint64_t>(value >= threshold) << i;
    nans |= static_cast<std::uint64_t>(value != value) << i;
    range.min = value < range.min ? value : range.min;
    range.max = value > range.max ? value : range.max;
  }
  inside = signs;
  range.nans += static_cast<std::uint64_t>(std::popcount(nans));
  return nans;
}

}  // namespace

bool fitsFloat(SampleType type) {
  return type == SampleType::kU8 || type == SampleType::kI8 || type == SampleType::kU16 || type == SampleType::kI16 ||
         type == SampleType::kF32;
}

template <class T>
FrameReader<T>::FrameReader(exchange::FrameSource& source) : source_(source), raw_(bytes(source.grid())) {
  static_assert(std::endian::native == std::endian::little, "the digest is over little-endian samples");
}

template <class T>
std::uint64_t FrameReader<T>::bytes(const exchange::GridInfo& grid) {
  return grid.type == kOwnType<T> ? 0 : grid.voxels() * sampleBytes(grid.type);
}

template <class T>
void FrameReader<T>::read(std::size_t frame, std::span<T> samples) {
  const std::span<std::byte> into = raw_.empty() ? std::as_writable_bytes(samples) : std::span(raw_);
  source_.readFrame(frame, into);
  frame_digests_.push_back(container::xxh3(into));
  if (!raw_.empty()) convert(source_.grid().type, std::span<const std::byte>(raw_), samples);
}

template <class T>
std::uint64_t FrameReader<T>::digest() const {
  return container::xxh3(std::as_bytes(std::span(frame_digests_)));
}

template <class T>
void classify(const GridShape& shape, std::span<const T> samples, double iso, bool keep_nan,
              outofcore::Executor& executor, FrameBits& bits, SampleRange& range) {
  const T threshold = thresholdOf<T>(iso);
  const std::size_t row_words = shape.rowWords();
  bits.inside.resize(shape.words());
  bits.nan.clear();
  std::vector<LayerRange<T>> layers(shape.dims[2]);
  const auto eachWord = [&](std::size_t z, const auto& visit) {
    for (std::uint64_t y = 0; y < shape.dims[1]; ++y) {
      const T* row = samples.data() + (z * shape.dims[1] + y) * shape.dims[0];
      for (std::size_t w = 0; w < row_words; ++w)
        visit(shape.rowStart(y, z) + w, row + w * 64, std::min<std::size_t>(64, shape.dims[0] - w * 64));
    }
  };
  executor.run(shape.dims[2], [&](std::size_t z) {
    eachWord(z, [&](std::size_t word, const T* first, std::size_t count) {
      classifyWord(first, count, threshold, bits.inside[word], layers[z]);
    });
  });
  std::uint64_t nans = 0;
  for (const LayerRange<T>& layer : layers) {
    range.min = std::min(range.min, static_cast<double>(layer.min));
    range.max = std::max(range.max, static_cast<double>(layer.max));
    nans += layer.nans;
  }
  range.nan_samples += nans;
  if (nans == 0 || !keep_nan) return;
  // A second look, only at frames that have any.
  bits.nan.resize(shape.words());
  executor.run(shape.dims[2], [&](std::size_t z) {
    LayerRange<T> ignored;
    eachWord(z, [&](std::size_t word, const T* first, std::size_t count) {
      std::uint64_t signs = 0;
      bits.nan[word] = classifyWord(first, count, threshold, signs, ignored);
    });
  });
}

std::array<std::uint64_t, 3> firstBit(const GridShape& shape, const BitPlane& plane) {
  const auto word = static_cast<std::size_t>(
      std::find_if(plane.begin(), plane.end(), [](std::uint64_t w) { return w != 0; }) - plane.begin());
  const std::uint64_t row = word / shape.rowWords();
  return {word % shape.rowWords() * 64 + static_cast<std::uint64_t>(std::countr_zero(plane[word])), row % shape.dims[1],
          row / shape.dims[1]};
}

template class FrameReader<float>;
template class FrameReader<double>;
template void classify(const GridShape&, std::span<const float>, double, bool, outofcore::Executor&, FrameBits&,
                       SampleRange&);
template void classify(const GridShape&, std::span<const double>, double, bool, outofcore::Executor&, FrameBits&,
                       SampleRange&);

}  // namespace tet4d::hypermesh
