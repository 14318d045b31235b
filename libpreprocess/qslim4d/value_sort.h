// Puts the values of vertices in the order of their numbers, however many they are. Private to qslim4d.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "libpreprocess/outofcore/record_files.h"
#include "libpreprocess/qslim4d/columns.h"

namespace tet4d::qslim4d {

class ValueSort {
 public:
  // stride: floats of a vertex. Vertices are distributed to files of ranges of numbers, each of which fits into memory;
  // the files' names begin with `prefix`.
  ValueSort(const std::string& prefix, std::uint64_t vertices, std::size_t stride, std::size_t buffer_bytes);

  // Every vertex once.
  void add(std::uint64_t number, std::span<const float> values);
  // Writes a file for each column, their values in the order of the columns. Call it once.
  void finish(std::span<const SlimColumn> columns, std::span<const std::string> paths);

  // What finish() holds beside buffers.
  static std::uint64_t rangeBytes(std::uint64_t vertices, std::size_t stride, std::size_t buffer_bytes);

 private:
  std::uint64_t vertices_;
  std::size_t stride_;
  std::uint64_t range_;
  std::size_t buffer_bytes_;
  outofcore::BucketFiles ranges_;
};

}  // namespace tet4d::qslim4d
