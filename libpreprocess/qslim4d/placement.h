// Where the vertex of a collapsed edge goes, and what that costs. Private to qslim4d.
//
// Aligned in time first: the minimum over space at the time of either end or of the frame between them, a 3x3 system.
// Then the free minimum, 4x4, then the ends. Ponchio & Hormann 2008, sec. 5 and 7.2 (vertices that share a time make
// fewer dynamic triangles).
#pragma once

#include <array>

#include "libpreprocess/qslim4d/quadric.h"
#include "libpreprocess/qslim4d/space.h"

namespace tet4d::qslim4d {

// Share of the quadric's weight that pulls towards the edge's middle. Directions in which the surface is flat are ruled
// by it (most vertices have a rank of 3 or less); others move by no more than this share.
inline constexpr double kPull = 1e-3;
// Share of the weight that an edge's squared length costs: orders collapses where the quadric says 0.
inline constexpr double kTieBreak = 1e-6;
// A place farther from the edge's middle than so many of its lengths, squared, is dropped.
inline constexpr double kFarthest2 = 2.25;

// What a vertex must keep: index-space coordinates that are prescribed (x y z t).
struct Fixed {
  unsigned mask = 0;  // bit c: coordinate c has value[c]
  std::array<float, 4> value{};
};

struct Placement {
  Vec4f at;
  double cost = 0;       // the quadric there, plus the tie-break by length
  double error = 0;      // sqrt(quadric / weight): a length, in mean cells
  bool aligned = false;  // its time is that of an end or of a frame
};

// q: of both ends together, about u. frames: whether a frame's time between the ends counts as aligned. align: a place
// aligned in time may cost (1 + align) times the free minimum. Regularised: a place may not leave the box of the edge,
// widened by its length, and is never worse than the better end. Deterministic; O(1).
Placement placeVertex(const Quadric& q, const Vec4f& u, const Vec4f& v, const Fixed& fixed, double align, bool frames,
                      const Space& space);

}  // namespace tet4d::qslim4d
