// Distributes a mesh to its cells, and finds the vertices that more than one cell uses. Private to qslim4d.
#pragma once

#include <cstdint>
#include <vector>

#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/cell_tree.h"

namespace tet4d::qslim4d {

// What the files of a cell hold.
struct CellSize {
  std::uint64_t tets = 0, slots = 0;       // slots: vertices, some more than once
  std::uint64_t vertices = 0, locked = 0;  // locked: those that other cells use too
  double expected = 0;                     // sum over the tetrahedra, see Piece
};

// Memory of the first users of a range of vertices.
std::uint64_t rangeBytes(std::uint64_t vertex_ids);

// Writes the files of `paths` for every cell of the tree: one pass over the source, and one over the numbers of the
// vertices it uses, which are below `vertex_ids`. Memory: a piece with about 24 bytes for each of its tetrahedra and
// vertices, and `buffer_bytes` or a little more. A vertex's values go to all cells that use it, its quadric and sums to
// the first of a piece's cells that does.
std::vector<CellSize> scatter(const PieceSource& source, const CellTree& tree, const FixedGrid& grid,
                              std::uint64_t vertex_ids, const VertexLoad& load, const CellPaths& paths,
                              std::size_t buffer_bytes);

}  // namespace tet4d::qslim4d
