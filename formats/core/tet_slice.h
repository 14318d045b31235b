// The slice of a space-time tetrahedron at a time, as dynamic triangles.
//
// Ponchio & Hormann 2008, sec. 3 (figure 4) and 7.1. The vertices of a tetrahedron sorted by time, t1 <= t2 <= t3 <=
// t4, have six edges e1 = v1v2, e2 = v1v3, e3 = v1v4, e4 = v2v3, e5 = v2v4, e6 = v3v4, and four triangles live on them:
//   D1 on [t1, t2): e1 e2 e3     D2 on [t2, t3): e2 e3 e4
//   D3 on [t2, t3): e3 e5 e4     D4 on [t3, t4): e3 e5 e6
// Corrections of the paper: its third triangle (e3 e4 e5) winds against the other three; lifespans must be half-open or
// frame times draw twice; an edge of constant time has no crossing and never appears, because its lifespans are empty.
// The lifespan of a triangle is the intersection of its edges' time intervals, so a shader can cull by edges alone.
//
// Orientation. A tetrahedron (a, b, c, d) is positive if det(n, b-a, c-a, d-a) > 0 for the 4D normal n that points out
// of the inside set. Its slice triangles then wind counter-clockwise seen from outside (normal out of the inside set).
#pragma once

#include <array>
#include <cstdint>

#include "formats/core/vec.h"

namespace tet4d {

// Ends of the six edges, as positions 0..3 in the time-sorted tetrahedron; the earlier end first.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kTetEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// One dynamic triangle of a tetrahedron: three edges (0..5) and the sorted positions whose times begin and end its
// life.
struct DynTriRule {
  std::array<std::uint8_t, 3> edges;
  std::uint8_t begin, end;
};

// The four triangles, wound alike for a tetrahedron that is positive in its time-sorted order.
inline constexpr std::array<DynTriRule, 4> kDynTriRules{{
    {{0, 1, 2}, 0, 1},
    {{1, 2, 3}, 1, 2},
    {{2, 4, 3}, 1, 2},
    {{2, 4, 5}, 2, 3},
}};

// A tetrahedron's vertices by time.
struct TimeOrder {
  std::array<std::uint8_t, 4> at;  // at[k] = position (0..3) in the given tetrahedron of the k-th earliest vertex
  bool odd;                        // the permutation is odd: the triangles' winding flips
};

// Sorts four times; equal times keep their order (stable), so the result depends on the input alone. NaN is not
// allowed.
TimeOrder orderByTime(float t0, float t1, float t2, float t3);

// Half-open lifespans, the last one closed: alive at t if begin <= t < end, or if t == end == last_t and begin < end.
inline bool isAlive(float begin, float end, float t, float last_t) {
  return begin < end && begin <= t && (t < end || (t == end && end == last_t));
}

// The crossing of the edge ab with the time t, a.t <= t <= b.t, a.t < b.t: exact at both ends, computed from a.
// The same formula stands in player/render/shaders/dyntri.vert.glsl.
inline Vec3f interpolateAt(const Vec4f& a, const Vec4f& b, float t) {
  if (t == b.t) return {b.x, b.y, b.z};
  const float lambda = (t - a.t) / (b.t - a.t);
  return {a.x + lambda * (b.x - a.x), a.y + lambda * (b.y - a.y), a.z + lambda * (b.z - a.z)};
}

}  // namespace tet4d
