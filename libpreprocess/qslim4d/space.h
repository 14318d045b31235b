// Lengths, normals and the time unit of a hypermesh while it is simplified. Private to qslim4d.
//
// All geometry stays in index space, where the f32 vertices are exact; differences are formed in double. World lengths
// come in through two matrices, so that anisotropic cells count as what they are.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "formats/core/coordinates.h"
#include "formats/core/vec.h"

namespace tet4d::qslim4d {

inline glm::dvec4 difference(const Vec4f& a, const Vec4f& b) {
  return {double{a.x} - double{b.x}, double{a.y} - double{b.y}, double{a.z} - double{b.z}, double{a.t} - double{b.t}};
}

inline glm::dvec3 spatial(const glm::dvec4& v) { return {v.x, v.y, v.z}; }

// The 4D cross product: the vector N with det(n, u, v, w) = n . N. |N| is six times the 3-volume of the tetrahedron.
inline glm::dvec4 cross4(const glm::dvec4& u, const glm::dvec4& v, const glm::dvec4& w) {
  const double xy = v.x * w.y - v.y * w.x, xz = v.x * w.z - v.z * w.x, xt = v.x * w.w - v.w * w.x;
  const double yz = v.y * w.z - v.z * w.y, yt = v.y * w.w - v.w * w.y, zt = v.z * w.w - v.w * w.z;
  return {u.y * zt - u.z * yt + u.w * yz, -(u.x * zt - u.z * xt + u.w * xz), u.x * yt - u.y * xt + u.w * xy,
          -(u.x * yz - u.y * xz + u.z * xy)};
}

struct Space {
  glm::dmat3 axes{1};     // index offsets to lengths, in units of the mean cell
  glm::dmat3 square{1};   // axes' axes: d . square d is a squared length
  glm::dmat3 normals{1};  // spatial parts of index-space cross products to those in the same units
  // Length per frame: how far a typical edge reaches in space over how far in time. Only a yardstick, for the
  // regularisation and for tetrahedra that stand almost still in space; covariant under a rescaling of time.
  double speed = 1;
  double cell = 1;  // the mean cell, world units

  double length(const glm::dvec4& offset) const { return glm::length(axes * spatial(offset)); }
  // Offset in lengths, time measured by `speed`.
  glm::dvec4 toLengths(const glm::dvec4& offset) const { return {axes * spatial(offset), speed * offset.w}; }
  double extent(const glm::dvec4& offset) const { return glm::length(toLengths(offset)); }
  glm::dvec3 spatialNormal(const glm::dvec4& cross) const { return normals * spatial(cross); }
};

// `speed` is left at 1. The map's axes must be usable.
Space spaceOf(const AffineMap& map);

}  // namespace tet4d::qslim4d
