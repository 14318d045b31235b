// Which cell a tetrahedron belongs to while a mesh is simplified out of core: a k-d tree over barycentres. Private to
// qslim4d.
//
// The tree depends on the mesh and the size of cells, never on memory or threads. Barycentres are sums of fixed-point
// integers, so that every comparison is exact and a tetrahedron's owner is the same whenever it is asked for.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/core/vec.h"

namespace tet4d::qslim4d {

// x y z t as integers.
using FixedPlace = std::array<std::int64_t, 4>;

// Integers for the places of a box: steps of a power of two, at most 2^40 along an axis.
class FixedGrid {
 public:
  FixedGrid() = default;
  explicit FixedGrid(const Bounds4f& bounds);
  FixedPlace placeOf(const Vec4f& v) const;
  // Length of one step along an axis, in index units.
  double step(std::size_t axis) const { return 1 / scale_[axis]; }

 private:
  std::array<double, 4> low_{}, scale_{1, 1, 1, 1};
};

// Where cells are cut in two: at the middle of their tetrahedra, or after a third and two thirds in turn. No plane of
// one is one of the other: k/2^m is never j/3^n (measured on a line of 16 cells: a sixth of a cell apart in the
// median).
enum class Cuts { kHalves, kThirds };

class CellTree {
 public:
  // sample: sums of four corners' places, of tetrahedra that stand for `tets` of them. Cells have at most `cell_tets`,
  // as far as the sample tells; they are cut across the longest extent, lengths being `units` a step. O(n log n).
  CellTree(std::vector<FixedPlace> sample, std::uint64_t tets, std::uint64_t cell_tets, Cuts cuts,
           const std::array<double, 4>& units);
  // sum: of four corners' places.
  std::uint32_t cellOf(const FixedPlace& sum) const;
  std::uint32_t cells() const { return cells_; }

 private:
  struct Node {
    std::int64_t at = 0;  // below it: the first child; else the second
    std::uint32_t axis = kLeaf;
    std::array<std::uint32_t, 2> children{};  // of a leaf: its cell
  };
  static constexpr std::uint32_t kLeaf = 4;
  struct Builder;

  std::vector<Node> nodes_;
  std::uint32_t cells_ = 0;
};

}  // namespace tet4d::qslim4d
