#include "formats/core/coordinates.h"

#include <algorithm>
#include <cmath>

namespace tet4d {

std::array<double, 3> toWorld(const AffineMap& map, const std::array<double, 3>& index) {
  std::array<double, 3> world = map.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t c = 0; c < 3; ++c) world[c] += index[axis] * map.axes[axis][c];
  }
  return world;
}

double cellVolume(const AffineMap& map) {
  const auto& [a, b, c] = map.axes;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

bool isUsable(const AffineMap& map) {
  for (double o : map.origin) {
    if (!std::isfinite(o)) return false;
  }
  for (const auto& axis : map.axes) {
    for (double a : axis) {
      if (!std::isfinite(a)) return false;
    }
  }
  const double volume = cellVolume(map);
  return std::isfinite(volume) && volume != 0;
}

bool isSameGrid(const AffineMap& a, const AffineMap& b) {
  double cell = 0;
  for (const auto& axis : a.axes) cell = std::max(cell, std::hypot(axis[0], axis[1], axis[2]));
  double distance = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    distance = std::max(distance, std::abs(a.origin[c] - b.origin[c]));
    for (std::size_t i = 0; i < 3; ++i) distance = std::max(distance, std::abs(a.axes[c][i] - b.axes[c][i]));
  }
  return distance <= 1e-6 * cell;
}

double timeOfFrame(std::span<const double> times, double frame) {
  const double last = static_cast<double>(times.size() - 1);
  const double clamped = std::clamp(frame, 0.0, last);
  const auto k = static_cast<std::size_t>(clamped);
  const double fraction = clamped - static_cast<double>(k);
  if (fraction == 0) return times[k];
  return times[k] + fraction * (times[k + 1] - times[k]);
}

double frameOfTime(std::span<const double> times, double time) {
  if (!(time > times.front())) return 0;
  if (time >= times.back()) return static_cast<double>(times.size() - 1);
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  const auto k = static_cast<std::size_t>(after - times.begin()) - 1;
  return static_cast<double>(k) + (time - times[k]) / (times[k + 1] - times[k]);
}

float sliceFrame(double frame) {
  const double nearest = std::round(frame);
  return static_cast<float>(std::abs(frame - nearest) <= 1e-9 * std::max(1.0, std::abs(nearest)) ? nearest : frame);
}

}  // namespace tet4d
