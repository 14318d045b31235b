// How many tetrahedra each cell of a sweep is to keep. Private to qslim4d.
//
// A uniform error is wanted, not a uniform share: where the surface is flat, more can go. What a cell's collapses cost
// in one sweep tells how far it would get for a higher cost: all cells are to end at the same.
#pragma once

#include <cstdint>
#include <vector>

#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/scatter.h"

namespace tet4d::qslim4d {

// By result, the tetrahedra it should have in the end for each that it has now, so that all collapses up to one cost
// are made and `total` are left: a power law through the collapses made so far, without locked vertices. At most 1.
std::vector<double> expectedShares(const std::vector<ResultHeader>& results, std::uint64_t total);

// Tetrahedra to keep, by cell: what hangs on locked vertices stays, the rest is shared out by CellSize::expected, so
// that `total` are left in all; or more, if else the free parts would fall below what is expected in the end.
std::vector<std::uint64_t> cellTargets(const std::vector<CellSize>& cells, std::uint64_t total);

}  // namespace tet4d::qslim4d
