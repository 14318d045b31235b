// What depends on the samples' type: their signs against isovalues, and where a surface crosses a grid edge. Samples
// stay in the source's own type; comparing and interpolating is exact to one rounding in double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "formats/core/sample_type.h"
#include "formats/core/vec.h"
#include "libpreprocess/hypermesh/simd.h"

namespace tet4d::hypermesh {

// What was seen of samples.
struct SampleRange {
  double min = std::numeric_limits<double>::infinity();  // of the samples that are no NaN; min > max: there is none
  double max = -std::numeric_limits<double>::infinity();
  std::uint64_t nan_samples = 0;
  void add(const SampleRange& other);
};

// What a row of signs looks like: whole rows that are alike need not be looked at again.
enum class RowState : std::uint8_t { kOutside = 0, kInside = 1, kMixed = 2 };

// Where the edges of a row of one direction lie, and the samples at their ends.
struct EdgeRowPlace {
  std::span<const std::uint64_t> bits;  // the cut edges of the row
  std::size_t lower, upper;             // sample index of the ends of the edge at x = 0
  std::uint8_t axes;                    // x 1, y 2, z 4, t 8
  std::uint64_t y, z, frame;            // of the base
};

class SampleKernels {
 public:
  virtual ~SampleKernels() = default;
  // Signs of `count` samples (value >= isovalue, compared as numbers, not as roundings): signs[i][w] of isovalue i and
  // 64 samples; bits behind the last sample are 0. states[i]: the row's. nans: a bit for each NaN, if not null; returns
  // whether there is any. Blocks of 64 samples whose range does not hold an isovalue cost one comparison.
  virtual bool classifyRow(const std::byte* samples, std::size_t count, std::span<std::uint64_t* const> signs,
                           RowState* states, std::uint64_t* nans, SampleRange& range) const = 0;
  // The vertices of a row's cut edges, in order (crossing.h). isovalue: number in the list given at creation.
  virtual Vec4f* placeRow(const EdgeRowPlace& row, const std::byte* lower, const std::byte* upper, std::size_t isovalue,
                          Vec4f* out) const = 0;
  virtual double isovalue(std::size_t i) const = 0;
  // Sample i as a number.
  virtual double value(const std::byte* samples, std::size_t i) const = 0;
};

// For samples of a type and a list of isovalues, finite.
std::unique_ptr<SampleKernels> makeSampleKernels(SampleType type, std::span<const double> isovalues,
                                                 Simd simd = bestSimd());

}  // namespace tet4d::hypermesh
