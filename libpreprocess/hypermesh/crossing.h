// Where the surface crosses an edge, and the vertex there.
//
// Always computed from the lower lattice index to the upper one, in double, so every cell and every thread gets the
// same bits. The fraction keeps kCrossingMargin away from both ends: a value equal to the isovalue would otherwise put
// the vertices of many edges into one lattice point and give tetrahedra without volume; the connectivity is right
// either way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "formats/core/vec.h"

namespace tet4d::hypermesh {

inline constexpr double kCrossingMargin = 1.0 / 8192;

// Largest index an axis (space or frames) may have, so that f32 has a number strictly between two neighbouring indices.
inline constexpr std::uint64_t kMaxIndex = std::uint64_t{1} << 22;

// Fraction of the way from v0 to v1 at which the value is iso; one of them is >= iso, the other is not (NaN is not).
//   both finite       (iso - v0) / (v1 - v0), kept in [margin, 1 - margin]
//   one infinite      at the margin next to the finite end, where the linear crossing tends to
//   both infinite     1/2
//   one NaN           at the margin next to the other end: what is unknown is given to the outside
inline double crossingFraction(double v0, double v1, double iso) {
  if (std::isnan(v0)) return 1 - kCrossingMargin;
  if (std::isnan(v1)) return kCrossingMargin;
  if (std::isinf(v0)) return std::isinf(v1) ? 0.5 : 1 - kCrossingMargin;
  if (std::isinf(v1)) return kCrossingMargin;
  double fraction = (iso - v0) / (v1 - v0);
  // The differences of very large doubles overflow; their halves do not.
  if (!std::isfinite(v1 - v0) || !std::isfinite(iso - v0)) fraction = (iso / 2 - v0 / 2) / (v1 / 2 - v0 / 2);
  return std::clamp(fraction, kCrossingMargin, 1 - kCrossingMargin);
}

// Coordinate index + fraction as f32, strictly between index and index + 1 (|index| < kMaxIndex, 0 < fraction < 1).
inline float strictlyBetween(std::int64_t index, double fraction) {
  const auto low = static_cast<float>(index), high = static_cast<float>(index + 1);
  const auto at = static_cast<float>(static_cast<double>(index) + fraction);
  if (at <= low) return std::nextafter(low, high);
  if (at >= high) return std::nextafter(high, low);
  return at;
}

}  // namespace tet4d::hypermesh
