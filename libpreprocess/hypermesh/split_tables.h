// Which table a split uses.
#pragma once

#include "libpreprocess/hypermesh/hull_table.h"
#include "libpreprocess/hypermesh/kuhn_table.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"

namespace tet4d::hypermesh {

inline const CellTable& tableOf(Split split) { return split == Split::kHull ? hullTable() : kuhnTable(); }

}  // namespace tet4d::hypermesh
