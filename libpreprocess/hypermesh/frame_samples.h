// The samples of one frame in memory, and what is kept of them when they go: signs, NaNs, range, digest.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/hypermesh/bit_planes.h"
#include "libpreprocess/outofcore/executor.h"

namespace tet4d::hypermesh {

// Whether float holds every value of the type exactly; the others are kept as double (64-bit integers are rounded).
bool fitsFloat(SampleType type);

// What was seen of all frames so far.
struct SampleRange {
  double min = std::numeric_limits<double>::infinity();  // of the samples that are no NaN; min > max: there is none
  double max = -std::numeric_limits<double>::infinity();
  std::uint64_t nan_samples = 0;
};

// Reads frames of a source, each once and in order, as T (float or double), and digests their bytes.
template <class T>
class FrameReader {
 public:
  explicit FrameReader(exchange::FrameSource& source);

  // samples: grid().voxels() numbers.
  void read(std::size_t frame, std::span<T> samples);
  // XXH3-64 over the XXH3-64s (u64) of the frames read, each over its samples in the source's type, little-endian.
  std::uint64_t digest() const;
  // Bytes it holds beside the caller's frames: the frame in the source's type, if that is not T.
  static std::uint64_t bytes(const exchange::GridInfo& grid);

 private:
  exchange::FrameSource& source_;
  std::vector<std::byte> raw_;
  std::vector<std::uint64_t> frame_digests_;
};

// Signs (value >= iso, compared as numbers, not as roundings) and NaNs of a frame, in tasks of one z layer; adds to
// `range`. `keep_nan`: fill bits.nan if there is a NaN. O(samples).
template <class T>
void classify(const GridShape& shape, std::span<const T> samples, double iso, bool keep_nan,
              outofcore::Executor& executor, FrameBits& bits, SampleRange& range);

// x, y, z of the first set bit; the plane must have one.
std::array<std::uint64_t, 3> firstBit(const GridShape& shape, const BitPlane& plane);

}  // namespace tet4d::hypermesh
