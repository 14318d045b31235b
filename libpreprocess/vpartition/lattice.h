// Places in space-time as integers, so that every comparison of distances is exact. Private to vpartition.
//
// A place is where a point lies in lengths: x y z in mean cells of the world, time in cells by the time scale, one step
// for all four. An owner found from places is the same on every machine and however often it is asked for.
#pragma once

#include <array>
#include <cstdint>

#include "formats/core/coordinates.h"
#include "formats/core/vec.h"
#include "formats/hypermesh.h"

namespace tet4d::vpartition {

// x y z t. Of a tetrahedron: the sum of its corners' places, that is four times its barycentre's.
using Place = std::array<std::int64_t, 4>;

inline constexpr int kPlaceBits = 20;  // of a corner's coordinate; sums have two more

class Lattice {
 public:
  // time_scale: mean cells that a frame counts as; above 0.
  Lattice(const Bounds4f& bounds, const AffineMap& map, double time_scale);

  Place placeOf(const Vec4f& v) const;
  // Sum over the corners.
  template <class Positions>
  Place placeOf(const hypermesh::Tet& tet, const Positions& positions) const {
    Place sum{};
    for (const auto v : tet) {
      const Place place = placeOf(positions[v]);
      for (std::size_t axis = 0; axis < 4; ++axis) sum[axis] += place[axis];
    }
    return sum;
  }
  double step() const { return step_; }  // mean cells

 private:
  std::array<std::array<double, 3>, 3> rows_{};  // index offsets to steps
  double time_ = 0;                              // frames to steps
  std::array<double, 4> origin_{};               // index space
  std::array<double, 4> low_{};                  // steps, of what lies farthest down
  double step_ = 1;
};

}  // namespace tet4d::vpartition
