// From index space to the numbers a renderer works with: world units relative to the centre of the data's box.
//
// A file far from the world's origin keeps its precision: the centre is subtracted in index space, where coordinates
// are small, and the camera is made relative to the same centre in double before anything becomes float.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "formats/core/coordinates.h"

namespace tet4d::scene {

struct WorldBox {
  glm::vec3 index_centre{0};            // cells
  glm::dvec3 centre{0};                 // world position of index_centre
  glm::dmat3 axes{1};                   // relative world = axes * (index - index_centre)
  std::array<glm::dvec3, 8> corners{};  // of the box, relative to `centre`, world units

  // A point of index space, relative to `centre`.
  glm::dvec3 toRelative(const glm::dvec3& index) const { return axes * (index - glm::dvec3(index_centre)); }
  // Radius of the sphere around `centre` through the corners; 0 for a single point.
  double radius() const;
};

// The eight corners of `box` (x, y, z only) in index space.
std::array<glm::dvec3, 8> cornersOf(const Bounds4f& box);

// `bounds`: of the vertices in index space; an empty box counts as the point 0.
WorldBox worldBox(const AffineMap& map, const Bounds4f& bounds);

}  // namespace tet4d::scene
