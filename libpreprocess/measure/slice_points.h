// A slice's points for measuring. Private to measure.
#pragma once

#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/slicer.h"
#include "libpreprocess/measure/triangle_tree.h"

namespace tet4d::measure {

// In world units, relative to the domain's corner: a far origin costs nothing.
inline std::vector<Point3> slicePoints(const SliceMesh& slice, const AffineMap& map, const Bounds4f& domain) {
  std::vector<Point3> points;
  points.reserve(slice.positions.size());
  for (const Vec3f& p : slice.positions) {
    const double x = double{p.x} - domain.min.x, y = double{p.y} - domain.min.y, z = double{p.z} - domain.min.z;
    Point3 world{};
    for (std::size_t c = 0; c < 3; ++c) world[c] = x * map.axes[0][c] + y * map.axes[1][c] + z * map.axes[2][c];
    points.push_back(world);
  }
  return points;
}

}  // namespace tet4d::measure
