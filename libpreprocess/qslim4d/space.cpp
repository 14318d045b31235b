#include "libpreprocess/qslim4d/space.h"

#include <cmath>
#include <glm/matrix.hpp>

namespace tet4d::qslim4d {

Space spaceOf(const AffineMap& map) {
  Space space;
  const double cell = std::cbrt(std::abs(cellVolume(map)));
  space.cell = cell;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& a = map.axes[static_cast<std::size_t>(axis)];
    space.axes[axis] = glm::dvec3(a[0], a[1], a[2]) / cell;
  }
  space.square = glm::transpose(space.axes) * space.axes;
  // Cross products of mapped vectors are the cofactor matrix times the cross product.
  space.normals = glm::determinant(space.axes) * glm::transpose(glm::inverse(space.axes));
  return space;
}

}  // namespace tet4d::qslim4d
