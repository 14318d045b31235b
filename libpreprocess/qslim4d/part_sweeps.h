// The sweeps of one part of a file, out of core. Private to qslim4d.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/outofcore/work_folder.h"
#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/cell_tree.h"
#include "libpreprocess/qslim4d/cells.h"
#include "libpreprocess/qslim4d/part_pages.h"

namespace tet4d::qslim4d {

// What all parts and tries of a run work with.
struct CellRun {
  const hypermesh::File& file;
  Metric metric;
  const CellOptions& cells;
  outofcore::Executor& executor;
  outofcore::MemoryBudget& memory;
  outofcore::Progress& progress;
  outofcore::WorkFolder& folder;
  const PartPages& pages;
  std::vector<SlimColumn> columns;  // that vertices carry, without values
  FixedGrid grid;
  std::size_t buffer_bytes;
  bool has_finished = false;  // something that a resumed run need not do again

  VertexLoad load() const { return loadOf(columns); }
};

struct PartOutcome {
  std::vector<std::string> results;  // of the last sweep, in the order of its cells
  std::vector<SweepReport> sweeps;
  Stats stats;
  NonManifold non_manifold;
  std::uint64_t tets = 0;  // left
  std::size_t most_in_flight = 0;
};

// Scatters and simplifies a part until its target is reached or nothing more goes; options: of this part. Goes on with
// what the journal lists as done. The part has tetrahedra.
PartOutcome sweepPart(CellRun& run, const PartTry& which, const Options& options);

// Bytes of scattering, with a piece of the file in hand: buffers, samples, first users of vertices.
std::uint64_t scatterBytes(const hypermesh::File& file, std::uint64_t cell_tets, const VertexLoad& load,
                           std::size_t buffer_bytes);
// Bytes of a cell's result in memory.
std::uint64_t resultBytes(std::uint64_t vertices, std::uint64_t tets, const VertexLoad& load);
// Of the largest of these.
std::uint64_t largestResult(const std::vector<std::string>& results, const VertexLoad& load);

}  // namespace tet4d::qslim4d
