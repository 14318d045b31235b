// Frames in memory, for tests: any sample type, and a record of what was read.
#pragma once

#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "libpreprocess/exchange/frame_source.h"

namespace tet4d::hypermesh::testing {

template <class T>
constexpr SampleType sampleTypeOf() {
  if constexpr (std::is_same_v<T, float>) return SampleType::kF32;
  if constexpr (std::is_same_v<T, double>) return SampleType::kF64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return SampleType::kU8;
  if constexpr (std::is_same_v<T, std::int8_t>) return SampleType::kI8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return SampleType::kU16;
  if constexpr (std::is_same_v<T, std::int16_t>) return SampleType::kI16;
  if constexpr (std::is_same_v<T, std::uint32_t>) return SampleType::kU32;
  if constexpr (std::is_same_v<T, std::uint64_t>) return SampleType::kU64;
  if constexpr (std::is_same_v<T, std::int32_t>) return SampleType::kI32;
  if constexpr (std::is_same_v<T, std::int64_t>) return SampleType::kI64;
}

template <class T>
class MemoryFrames final : public exchange::FrameSource {
 public:
  using Field = std::function<T(std::uint64_t x, std::uint64_t y, std::uint64_t z, std::uint64_t frame)>;

  MemoryFrames(std::array<std::uint64_t, 3> dims, std::size_t frames, const Field& field) {
    grid_.dims = dims;
    grid_.type = sampleTypeOf<T>();
    for (std::size_t k = 0; k < frames; ++k) {
      times_.push_back(static_cast<double>(k));
      for (std::uint64_t z = 0; z < dims[2]; ++z)
        for (std::uint64_t y = 0; y < dims[1]; ++y)
          for (std::uint64_t x = 0; x < dims[0]; ++x) samples_.push_back(field(x, y, z, k));
    }
  }

  const exchange::GridInfo& grid() const override { return grid_; }
  const std::vector<double>& times() const override { return is_stream_ ? known_times_ : times_; }
  bool isStream() const override { return is_stream_; }
  bool hasFrame(std::size_t k) override {
    if (k >= times_.size()) return false;
    while (is_stream_ && known_times_.size() <= k) known_times_.push_back(times_[known_times_.size()]);
    return true;
  }
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    if (z_begin == 0) reads.push_back(k);
    const std::uint64_t layer = grid_.dims[0] * grid_.dims[1];
    std::memcpy(samples.data(), samples_.data() + k * grid_.voxels() + z_begin * layer,
                (z_end - z_begin) * layer * sizeof(T));
  }
  std::string frameName(std::size_t k) const override { return "memory frame " + std::to_string(k); }

  T at(std::uint64_t x, std::uint64_t y, std::uint64_t z, std::uint64_t k) const {
    return samples_[((k * grid_.dims[2] + z) * grid_.dims[1] + y) * grid_.dims[0] + x];
  }
  std::span<const T> samples() const { return samples_; }
  MemoryFrames& map(const AffineMap& index_to_world) { return grid_.index_to_world = index_to_world, *this; }
  MemoryFrames& times(std::vector<double> world) { return times_ = std::move(world), *this; }
  // Frames become known one after the other.
  MemoryFrames& asStream() { return is_stream_ = true, *this; }

  std::vector<std::size_t> reads;  // frames in the order they were asked for

 private:
  exchange::GridInfo grid_;
  std::vector<double> times_, known_times_;
  bool is_stream_ = false;
  std::vector<T> samples_;
};

}  // namespace tet4d::hypermesh::testing
