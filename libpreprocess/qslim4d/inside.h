// Keeps new vertices inside the domain. Private to qslim4d.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libpreprocess/qslim4d/placement.h"

namespace tet4d::qslim4d {

// The minimum of a quadric may lie beyond a wall that neither end stands on: a vertex there would be outside the
// domain, before its first time or past its last one. Such coordinates go back between those of the ends, which keeps
// them off the wall, and the place is priced again. q: about u, as placeVertex() had it. True if the place has moved.
inline bool keepInside(const Quadric& q, const Vec4f& u, const Vec4f& v, const Fixed& fixed, const Bounds4f& domain,
                       Placement& placement) {
  const std::array<float, 4> low{domain.min.x, domain.min.y, domain.min.z, domain.min.t};
  const std::array<float, 4> high{domain.max.x, domain.max.y, domain.max.z, domain.max.t};
  const std::array<float, 4> a{u.x, u.y, u.z, u.t}, b{v.x, v.y, v.z, v.t};
  std::array<float, 4> p{placement.at.x, placement.at.y, placement.at.z, placement.at.t};
  bool has_moved = false;
  for (std::size_t c = 0; c < 4; ++c) {
    if ((fixed.mask >> c & 1u) != 0 || (p[c] > low[c] && p[c] < high[c])) continue;
    const float between = std::clamp(p[c], std::min(a[c], b[c]), std::max(a[c], b[c]));
    has_moved |= between != p[c];
    p[c] = between;
  }
  if (!has_moved) return false;
  const float moved_from_t = placement.at.t;
  const double tie_break = placement.cost - q.value(difference(placement.at, u));
  placement.at = {p[0], p[1], p[2], p[3]};
  const double value = q.value(difference(placement.at, u));
  placement.cost = value + std::max(0.0, tie_break);
  placement.error = q.weight > 0 ? std::sqrt(value / q.weight) : 0;
  placement.aligned = placement.aligned || p[3] != moved_from_t;  // back at an end's time
  return true;
}

}  // namespace tet4d::qslim4d
