#include "player/scene/world_box.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace tet4d::scene {

double WorldBox::radius() const {
  double radius = 0;
  for (const glm::dvec3& corner : corners) radius = std::max(radius, glm::length(corner));
  return radius;
}

std::array<glm::dvec3, 8> cornersOf(const Bounds4f& box) {
  std::array<glm::dvec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i) {
    corners[i] = {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                  (i & 4) != 0 ? box.max.z : box.min.z};
  }
  return corners;
}

WorldBox worldBox(const AffineMap& map, const Bounds4f& bounds) {
  const Bounds4f box = bounds.empty() ? Bounds4f{{0, 0, 0, 0}, {0, 0, 0, 0}} : bounds;
  WorldBox world;
  world.index_centre = {0.5f * box.min.x + 0.5f * box.max.x, 0.5f * box.min.y + 0.5f * box.max.y,
                        0.5f * box.min.z + 0.5f * box.max.z};
  const std::array<double, 3> centre = toWorld(map, {world.index_centre.x, world.index_centre.y, world.index_centre.z});
  world.centre = {centre[0], centre[1], centre[2]};
  for (int axis = 0; axis < 3; ++axis) {
    const auto& a = map.axes[static_cast<std::size_t>(axis)];
    world.axes[axis] = {a[0], a[1], a[2]};
  }
  const auto corners = cornersOf(box);
  std::transform(corners.begin(), corners.end(), world.corners.begin(),
                 [&](const glm::dvec3& corner) { return world.toRelative(corner); });
  return world;
}

}  // namespace tet4d::scene
