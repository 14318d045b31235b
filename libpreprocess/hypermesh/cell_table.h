// The unit 4-cube of marching hypercubes: its corners, its edges, and what a split of it into tetrahedra looks like.
//
// Corner i has x = i & 1, y = i >> 1 & 1, z = i >> 2 & 1, t = i >> 3 & 1. A configuration is a 16-bit number whose bit
// i says that corner i is inside (value >= isovalue). An edge leads from its base corner to base | direction, where
// direction is a mask of axes (x 1, y 2, z 4, t 8) that the base has at 0; one axis for the cube's own edges, more for
// the diagonals of a simplicial split. One vertex sits on each edge whose ends differ.
//
// Every triangulation in this room pulls: a face is split from the vertex that is lowest in one order over the whole
// lattice, so cells that share a face split it alike. The order compares edge midpoints by t, then z, then y, then x.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tet4d::hypermesh {

inline constexpr unsigned kConfigurations = 65536;

// An edge of the cell, as axis mask and base corner.
struct CellEdge {
  std::uint8_t direction;
  std::uint8_t base;
  friend bool operator==(const CellEdge&, const CellEdge&) = default;
};

// A tetrahedron of a cell: four edge numbers. Positive in the sense of formats/core/tet_slice.h with the edges'
// midpoints.
using CellTet = std::array<std::uint8_t, 4>;

// Midpoint of an edge in doubled coordinates, 0..2 each: x, y, z, t.
constexpr std::array<int, 4> doubledMidpoint(CellEdge edge) {
  std::array<int, 4> point{};
  for (unsigned axis = 0; axis < 4; ++axis) {
    const int base_bit = static_cast<int>(edge.base >> axis & 1u);
    const int direction_bit = static_cast<int>(edge.direction >> axis & 1u);
    point[axis] = 2 * base_bit + direction_bit;
  }
  return point;
}

// Place of an edge in the pulling order: smaller is lower. Distinct for distinct edges of one cell.
constexpr int pullingRank(CellEdge edge) {
  const auto point = doubledMidpoint(edge);
  return ((point[3] * 3 + point[2]) * 3 + point[1]) * 3 + point[0];
}

// The edges of one direction and how a cell numbers them.
struct EdgeDirection {
  std::uint8_t axes;                    // axis mask
  std::uint16_t bases;                  // bit b: corner b is the base of an edge of this direction
  std::array<std::uint8_t, 16> number;  // number[b]: the number of the edge at base b
};

// A split of the cell: for each configuration its tetrahedra. A view; the table lives as long as the program.
struct CellTable {
  std::span<const EdgeDirection> directions;  // those within a frame (no t) first, axis masks ascending
  std::span<const CellEdge> edges;            // by edge number
  std::span<const std::uint32_t> offsets;     // kConfigurations + 1 entries
  std::span<const CellTet> tets;
  unsigned max_tets;  // the most any configuration has

  std::span<const CellTet> of(unsigned configuration) const {
    return tets.subspan(offsets[configuration], offsets[configuration + 1] - offsets[configuration]);
  }
  unsigned count(unsigned configuration) const { return offsets[configuration + 1] - offsets[configuration]; }
};

// Determinant of a 4x4 integer matrix given by rows. Exact for the small entries of this room.
int determinant4(const std::array<std::array<int, 4>, 4>& rows);

// Numbers the edges of the given axis masks: direction by direction, base corners ascending.
std::vector<EdgeDirection> numberEdges(std::span<const std::uint8_t> axis_masks, std::vector<CellEdge>& edges);

}  // namespace tet4d::hypermesh
