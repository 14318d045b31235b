// Simplifies the cells of one sweep. Private to qslim4d.
#pragma once

#include <cstdint>
#include <vector>

#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/outofcore/work_folder.h"
#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/scatter.h"

namespace tet4d::qslim4d {

struct SweepTask {
  PartTry which;
  std::size_t sweep = 0;
  std::vector<CellSize> cells;
  std::vector<std::uint64_t> targets;  // tetrahedra to be left, by cell
  Metric metric = Metric::kSlice;
  Bounds4f domain;
  AffineMap map;
  double speed = 1;                 // of the input, see Space
  std::vector<SlimColumn> columns;  // that vertices carry, without values
  bool keep_non_manifold = false;
  Options options;  // but for the target
};

// Bytes that a cell takes while it is loaded and simplified.
std::uint64_t cellBytes(const CellSize& cell, const VertexLoad& load);

// Simplifies all cells that the journal of `folder` does not list ("cell SWEEP CELL", and the suffix of the part),
// leaves their results and removes what they were made from. Returns how many were in flight at most. Throws
// Error{kOutOfMemory} if not even one fits.
std::size_t runSweep(const SweepTask& task, outofcore::WorkFolder& folder, outofcore::Executor& executor,
                     outofcore::MemoryBudget& memory, outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
