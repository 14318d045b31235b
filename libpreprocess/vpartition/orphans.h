// Cells in one piece. Private to vpartition.
//
// With a norm for each site a cell need not be connected, and where a surface folds no cell is: a piece apart is little
// but border, which stays locked. It goes to the cell it touches most.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/hypermesh.h"

namespace tet4d::vpartition {

// Changes `owners` (of the tetrahedra, below 2^32 - 1) so that what a cell has of each connected part of the mesh hangs
// together by vertices: all but the largest piece, of equal ones the first, go to the cell beside them that shares most
// of their corners. Returns how many pieces went. O(tets) a round, few rounds; 28 bytes a tetrahedron, 4 a vertex.
std::uint64_t mergeOrphans(std::span<const hypermesh::Tet> tets, std::size_t vertices, std::span<std::uint32_t> owners);

}  // namespace tet4d::vpartition
