// The convex-hull table of marching hypercubes, made at build time by hull_table_gen and kept in the program's
// read-only data (3.6 MB). Bhaniramka, Wenger & Crawfis 2000/2004. 847,760 tetrahedra, at most 24 a configuration.
#pragma once

#include "libpreprocess/hypermesh/cell_table.h"

namespace tet4d::hypermesh {

// 32 edges in 4 directions; numbers as in hull_facets.h. Constant time, thread-safe.
const CellTable& hullTable();

}  // namespace tet4d::hypermesh
