#include "libpreprocess/measure/slice_measures.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libpreprocess/measure/compensated_sum.h"

namespace tet4d::measure {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Vec3d = std::array<double, 3>;

Vec3d cross(const Vec3d& u, const Vec3d& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

void countEdges(std::span<const Triangle> triangles, SliceMeasures& result) {
  struct Side {
    std::uint32_t low, high;
    bool forward;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = triangle[c], b = triangle[(c + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  for (std::size_t i = 0; i < sides.size();) {
    const std::uint32_t low = sides[i].low, high = sides[i].high;
    std::size_t uses = 0, forward = 0;
    for (; i < sides.size() && sides[i].low == low && sides[i].high == high; ++i) {
      ++uses;
      forward += sides[i].forward ? 1 : 0;
    }
    ++result.edges;
    if (uses == 1) ++result.boundary_edges;
    if (uses == 2 && forward != 1) ++result.misoriented_edges;
    if (uses > 2) ++result.edges_over_two;
    if (2 * forward != uses) ++result.unbalanced_edges;
  }
}

}  // namespace

SliceMeasures measureSlice(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                           const AffineMap& map) {
  SliceMeasures result;
  result.triangles = triangles.size();
  countEdges(triangles, result);
  if (triangles.empty()) return result;

  std::vector<bool> used(positions.size());
  CompensatedSum area, volume;
  // Relative to a vertex of the mesh, so that an origin far away cancels before anything is squared.
  const Vec3f& origin = positions[triangles[0][0]];
  const auto toLocalWorld = [&](const Vec3f& p) {
    AffineMap linear = map;
    linear.origin = {0, 0, 0};
    return toWorld(linear, {double{p.x} - origin.x, double{p.y} - origin.y, double{p.z} - origin.z});
  };
  for (const Triangle& triangle : triangles) {
    std::array<Vec3d, 3> p;
    for (std::size_t c = 0; c < 3; ++c) {
      used[triangle[c]] = true;
      p[c] = toLocalWorld(positions[triangle[c]]);
    }
    const Vec3d u{p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]};
    const Vec3d v{p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]};
    const Vec3d n = cross(u, v);
    area.add(std::hypot(n[0], n[1], n[2]) / 2);
    // p0 . n / 6 is the signed volume of the cone from the origin.
    volume.add((p[0][0] * n[0] + p[0][1] * n[1] + p[0][2] * n[2]) / 6);
  }
  result.vertices = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  result.area = area.value();
  result.volume = std::copysign(1.0, cellVolume(map)) * volume.value();
  return result;
}

}  // namespace tet4d::measure
