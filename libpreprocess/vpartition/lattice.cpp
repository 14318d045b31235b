#include "libpreprocess/vpartition/lattice.h"

#include <algorithm>
#include <cmath>

namespace tet4d::vpartition {

Lattice::Lattice(const Bounds4f& bounds, const AffineMap& map, double time_scale) {
  const double cell = std::cbrt(std::abs(cellVolume(map)));
  if (bounds.empty()) return;
  origin_ = {bounds.min.x, bounds.min.y, bounds.min.z, bounds.min.t};
  const std::array<double, 3> reach{double{bounds.max.x} - origin_[0], double{bounds.max.y} - origin_[1],
                                    double{bounds.max.z} - origin_[2]};
  std::array<double, 4> extent{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows_[row][axis] = map.axes[axis][row] / cell;
      const double along = rows_[row][axis] * reach[axis];
      low_[row] += std::min(0.0, along);
      extent[row] += std::abs(along);
    }
  }
  time_ = time_scale;
  extent[3] = (double{bounds.max.t} - origin_[3]) * time_scale;
  // A power of two: the products below are exact but for the rows' own rounding.
  int exponent = 0;
  std::frexp(*std::max_element(extent.begin(), extent.end()), &exponent);
  const double scale = std::ldexp(1.0, kPlaceBits - std::clamp(exponent, -900, 900));
  for (auto& row : rows_)
    for (double& value : row) value *= scale;
  for (double& low : low_) low *= scale;
  time_ *= scale;
  step_ = 1 / scale;
}

Place Lattice::placeOf(const Vec4f& v) const {
  const std::array<double, 4> d{double{v.x} - origin_[0], double{v.y} - origin_[1], double{v.z} - origin_[2],
                                double{v.t} - origin_[3]};
  constexpr double kMost = static_cast<double>(std::int64_t{1} << (kPlaceBits + 1));
  Place place{};
  for (std::size_t row = 0; row < 3; ++row) {
    const double at = rows_[row][0] * d[0] + rows_[row][1] * d[1] + rows_[row][2] * d[2] - low_[row];
    place[row] = static_cast<std::int64_t>(std::clamp(at, 0.0, kMost));
  }
  place[3] = static_cast<std::int64_t>(std::clamp(time_ * d[3], 0.0, kMost));
  return place;
}

}  // namespace tet4d::vpartition
