#include "libpreprocess/qslim4d/value_sort.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

namespace tet4d::qslim4d {
namespace {

constexpr std::size_t kReadBuffer = std::size_t{1} << 20;

// Vertices that are put in order together; more of them where that would be too many files.
std::uint64_t rangeOf(std::uint64_t vertices, std::size_t stride, std::size_t buffer_bytes) {
  constexpr std::uint64_t kMostRanges = 1024;
  const std::uint64_t fitting = buffer_bytes / std::max<std::size_t>(1, 2 * stride * sizeof(float));
  return std::max({fitting, (vertices + kMostRanges - 1) / kMostRanges, std::uint64_t{1024}});
}

}  // namespace

ValueSort::ValueSort(const std::string& prefix, std::uint64_t vertices, std::size_t stride, std::size_t buffer_bytes)
    : vertices_(vertices),
      stride_(stride),
      range_(rangeOf(vertices, stride, buffer_bytes)),
      buffer_bytes_(buffer_bytes),
      ranges_(prefix, stride == 0 ? 0 : static_cast<std::size_t>((vertices + range_ - 1) / range_), buffer_bytes) {}

void ValueSort::add(std::uint64_t number, std::span<const float> values) {
  const auto range = static_cast<std::size_t>(number / range_);
  ranges_.add(range, number);
  ranges_.addRun(range, values);
}

void ValueSort::finish(std::span<const SlimColumn> columns, std::span<const std::string> paths) {
  ranges_.finish();
  for (const std::string& path : paths) outofcore::writeFile(path, {});
  std::vector<float> values, column;
  for (std::size_t range = 0; range < ranges_.size(); ++range) {
    const std::uint64_t first = range * range_, count = std::min(range_, vertices_ - first);
    values.assign(count * stride_, 0);
    // A record: the number as two words, and the values.
    outofcore::RecordReader<std::uint32_t> reader(ranges_.path(range), std::min(buffer_bytes_, kReadBuffer));
    for (std::array<std::uint32_t, 2> words{}; reader.next(words[0]);) {
      reader.next(words[1]);
      const std::uint64_t at = (std::bit_cast<std::uint64_t>(words) - first) * stride_;
      for (std::size_t i = 0; i < stride_; ++i) {
        reader.next(words[0]);
        values[at + i] = std::bit_cast<float>(words[0]);
      }
    }
    outofcore::removeFile(ranges_.path(range));
    std::size_t at = 0;
    for (std::size_t c = 0; c < columns.size(); at += columns[c++].components) {
      const std::size_t n = columns[c].components;
      column.resize(count * n);
      for (std::size_t v = 0; v < count; ++v) std::copy_n(values.data() + v * stride_ + at, n, column.data() + v * n);
      outofcore::appendFile(paths[c], std::as_bytes(std::span<const float>(column)));
    }
  }
}

std::uint64_t ValueSort::rangeBytes(std::uint64_t vertices, std::size_t stride, std::size_t buffer_bytes) {
  return stride == 0 ? 0 : rangeOf(vertices, stride, buffer_bytes) * 2 * stride * sizeof(float);
}

}  // namespace tet4d::qslim4d
