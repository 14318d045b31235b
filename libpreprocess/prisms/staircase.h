// The tetrahedra between a triangle's three lifelines: Ponchio & Hormann 2008, sec. 4.2, for vertices that are kept at
// different frames.
//
// A front is three vertices, one a lifeline. The vertex whose next kept frame comes first goes ahead, among equals the
// one with the larger number, and each such step adds the tetrahedron of the front and the vertex it reaches. With all
// frames kept a step in time gives three, diagonals from the smaller vertex at the bottom. The order of two vertices'
// steps depends on those two only, so triangles that share an edge agree about the wall over it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "libpreprocess/prisms/surface_edges.h"
#include "libpreprocess/prisms/window.h"

namespace tet4d::prisms {

// The last kept frame at or before f.
inline unsigned keptBefore(Kept kept, unsigned f) {
  return 63U - static_cast<unsigned>(std::countl_zero(kept & ((Kept{2} << f) - 1)));
}

// Calls emit(front, corner, frame) for every tetrahedron whose earliest vertex is kept at frame f: front[i] is the
// frame of the triangle's corner i, `corner` the one that goes ahead to `frame`. The tetrahedron (front 0, 1, 2, then
// the vertex reached) is positive if the triangle is counter-clockwise from outside. kept[i]: of the triangle's corner
// i.
template <class Emit>
void forEachTetAt(const Triangle& triangle, const std::array<Kept, 3>& kept, unsigned f, Emit emit) {
  if (((kept[0] | kept[1] | kept[2]) >> f & 1) == 0) return;
  std::array<unsigned, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](unsigned i, unsigned j) { return triangle[i] > triangle[j]; });
  std::array<unsigned, 3> front{keptBefore(kept[0], f), keptBefore(kept[1], f), keptBefore(kept[2], f)};
  const auto earliest = [&] { return std::min({front[0], front[1], front[2]}); };
  Kept ahead = (kept[0] | kept[1] | kept[2]) & ~((Kept{2} << f) - 1);
  for (; ahead != 0 && earliest() <= f; ahead &= ahead - 1) {
    const auto frame = static_cast<unsigned>(std::countr_zero(ahead));
    for (const unsigned corner : order) {
      if ((kept[corner] >> frame & 1) == 0) continue;
      if (earliest() == f) emit(front, corner, frame);
      front[corner] = frame;
    }
  }
}

// Calls visit(l, h, is_low_first) for every diagonal of the wall over an edge: from the vertex kept at l to that kept
// at h, l < h; is_low_first: the one at l is edge.low.
template <class Visit>
void forEachDiagonal(Kept low, Kept high, Visit visit) {
  Kept ahead = (low | high) & ((low | high) - 1);  // all but the first frame
  unsigned at_low = static_cast<unsigned>(std::countr_zero(low)), at_high = at_low;
  for (; ahead != 0; ahead &= ahead - 1) {
    const auto frame = static_cast<unsigned>(std::countr_zero(ahead));
    const Kept bit = ahead & (~ahead + 1);
    if ((high & bit) != 0) {
      visit(at_low, frame, true);
      at_high = frame;
    }
    if ((low & bit) != 0) {
      if (at_high != frame) visit(at_high, frame, false);
      at_low = frame;
    }
  }
}

}  // namespace tet4d::prisms
