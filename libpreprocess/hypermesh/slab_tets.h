// The tetrahedra of one slab, from bit planes alone: no sample is needed once the vertices are numbered.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/hypermesh/bit_planes.h"
#include "libpreprocess/hypermesh/cell_table.h"

namespace tet4d::hypermesh {

// A slab's planes; all must outlive the SlabTets made from it.
struct Slab {
  const GridShape& shape;
  const SignPlane& inside_lower;  // frame k
  const SignPlane& inside_upper;  // frame k + 1
  const BitPlane& usable;         // cells to split, empty for all
  const EdgeSet& lower;           // F_k: local vertices from 0
  const EdgeSet& between;         // E_k: after F_k
  const EdgeSet& upper;           // F_{k+1}: after E_k
};

class SlabTets {
 public:
  SlabTets(const CellTable& table, const Slab& slab, Simd simd);

  struct Count {
    std::uint64_t active_cells = 0, tets = 0;
  };
  // Cells in layer z (0 .. dims[2] - 2) whose corners are not all alike, and their tetrahedra.
  Count countLayer(std::uint64_t z) const { return count_(*this, z); }
  // Writes the layer's tetrahedra, cells in the order x, y: exactly countLayer(z).tets. Thread-safe.
  void emitLayer(std::uint64_t z, std::span<Tet> out) const { emit_(*this, z, out); }

 private:
  friend struct SlabLoops;
  // Where an edge of the cell at x = 0 of a row finds its number.
  struct EdgeRow {
    const EdgePlane* plane;
    std::size_t row;  // first word of the row the edge's base is in
    std::uint32_t first_local;
    unsigned dx;
  };
  void startRow(std::uint64_t y, std::uint64_t z, std::span<EdgeRow> rows) const;
  bool isRowAlike(std::uint64_t y, std::uint64_t z) const;

  const CellTable& table_;
  Slab slab_;
  std::vector<EdgeRow> edges_;  // by edge number; row still 0
  Count (*count_)(const SlabTets&, std::uint64_t);
  void (*emit_)(const SlabTets&, std::uint64_t, std::span<Tet>);
};

}  // namespace tet4d::hypermesh
