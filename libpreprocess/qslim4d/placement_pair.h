// What two edges at one vertex cost, worked out side by side. Private to qslim4d.
//
// The same numbers as placeVertex() and keepInside() give, to the bit: the same operations in the same order, one edge
// in each half of a vector register. Two halves are what every 64-bit processor has, so there is one set of bytes and
// nothing to choose at run time.
#pragma once

#include <array>

#include "libpreprocess/qslim4d/placement.h"

namespace tet4d::qslim4d {

struct PairCosts {
  std::array<double, 2> cost{}, error{};  // as in Placement
  std::array<bool, 2> is_usual{};         // false: the place is on a wall or beyond one, and needs keepInside()
};

// The edges from u to two others, with no coordinate fixed; `from` and `to` hold quadrics about their vertices.
PairCosts costPair(const Quadric& from, const Vec4f& u, const std::array<const Quadric*, 2>& to,
                   const std::array<const Vec4f*, 2>& others, double align, bool frames, const Space& space,
                   const Bounds4f& domain);

}  // namespace tet4d::qslim4d
