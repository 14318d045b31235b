// The Kuhn (Freudenthal) split as an oracle for the hull table: 24 pentatopes a cell, one for each order in which a
// walk from corner 0 to corner 15 can take the axes; each pentatope's surface is a tetrahedron or a prism.
//
// About 5.3 times the tetrahedra of the hull table, but it needs no table of ambiguous cases to be right, so the two
// check each other. Prisms are split by the same pulling order as the hull's facets.
#pragma once

#include "libpreprocess/hypermesh/cell_table.h"

namespace tet4d::hypermesh {

// 65 edges in 15 directions; 3,440,640 tetrahedra, at most 72 a configuration. The first call builds it (14 MB, about
// 0.2 s); thread-safe.
const CellTable& kuhnTable();

}  // namespace tet4d::hypermesh
