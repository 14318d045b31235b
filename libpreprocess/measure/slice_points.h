// A slice's points for measuring. Private to measure.
#pragma once

#include <array>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/slicer.h"
#include "libpreprocess/measure/triangle_tree.h"

namespace tet4d::measure {

// In world units, relative to the place `corner` of index space: where it is near, a far origin costs nothing.
inline std::vector<Point3> slicePoints(const SliceMesh& slice, const AffineMap& map,
                                       const std::array<double, 3>& corner) {
  std::vector<Point3> points;
  points.reserve(slice.positions.size());
  for (const Vec3f& p : slice.positions) {
    const double x = double{p.x} - corner[0], y = double{p.y} - corner[1], z = double{p.z} - corner[2];
    Point3 world{};
    for (std::size_t c = 0; c < 3; ++c) world[c] = x * map.axes[0][c] + y * map.axes[1][c] + z * map.axes[2][c];
    points.push_back(world);
  }
  return points;
}

// Relative to the domain's corner.
inline std::vector<Point3> slicePoints(const SliceMesh& slice, const AffineMap& map, const Bounds4f& domain) {
  return slicePoints(slice, map, std::array<double, 3>{domain.min.x, domain.min.y, domain.min.z});
}

}  // namespace tet4d::measure
