// Where a column's values lie: what a map of colours is stretched over.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "formats/core/result.h"
#include "formats/dynamic_triangles.h"

namespace tet4d::scene {

// Of the finite values. Without one, all is 0 to 1.
struct ColumnSpread {
  float least = 0, most = 1;
  float low = 0, high = 1;                // without a hundredth at either end: a few odd ones must not take all colours
  float least_above_zero = 0;             // 0: none is
  std::uint64_t values = 0, unknown = 0;  // finite ones; NaN and infinities
  // True if what lies between the ends is rounding: less than 1e-5 of the larger one.
  bool isOneValue() const {
    return values > 0 &&
           double{most} - double{least} <= 1e-5 * std::max(std::abs(double{least}), std::abs(double{most}));
  }
  float middle() const { return static_cast<float>(0.5 * (double{least} + double{most})); }
};

// Of a component, or kMagnitude of a row. Reads all of the column, a page at a time; low and high are of every value in
// small files, of evenly taken ones in large ones. After each page `go_on(pages read, pages)` may say false: the Fault
// is then kUsage. O(the column); memory of a page of it and of 2^20 numbers. Any thread.
Result<ColumnSpread> spreadOf(const dyntri::File& file, std::size_t column, int component,
                              const std::function<bool(std::size_t, std::size_t)>& go_on);

}  // namespace tet4d::scene
