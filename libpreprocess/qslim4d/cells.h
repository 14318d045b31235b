// Simplification out of core: cells of bounded size, each simplified on its own, in sweeps whose cells are displaced.
// Ponchio & Hormann 2008, sec. 5 and 6.
//
// A sweep cuts the mesh by a k-d tree over barycentres, scatters it to files, and collapses edges within each cell.
// Vertices that several cells use are locked, so that every star a collapse touches is whole: what is judged in a cell
// holds for the mesh. The next sweep is cut elsewhere, with the quadrics of the one before; what was locked is inside
// there. The bytes depend on the mesh, the options and the size of cells; not on memory, threads or interrupts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/qslim4d/simplify.h"

namespace tet4d::qslim4d {

inline constexpr std::uint64_t kCellTets = 8'000'000;

struct CellOptions {
  std::uint64_t cell_tets = kCellTets;  // a cell has no more, as far as half a million samples tell
  std::string folder;                   // for temporary files; made, and removed at the end
  std::string run_name;                 // one line: the input's digest and what changes the result
  bool resume = false;                  // go on with what an interrupted run of that name left in the folder
};

struct SweepReport {
  std::uint64_t cells = 0, tets_in = 0, tets_out = 0;
};

struct CellReport {
  Stats stats;  // of all sweeps
  std::uint64_t vertices = 0, tets = 0;
  std::vector<SweepReport> sweeps;
  std::size_t most_in_flight = 0;  // cells that were in memory at a time, at most
};

// Bytes that a cell of `cell_tets` of this file takes at most, with what the program holds beside it: the least
// --memory that does. Temporary bytes on disk.
std::uint64_t boundCellMemory(const hypermesh::File& file, std::uint64_t cell_tets);
std::uint64_t boundTemporaryBytes(const hypermesh::File& file);

// Simplifies `file` into `writer`, which is not closed (phases "read", "scatter", "simplify", "write"). As many cells
// are in flight as there are threads and `memory` allows, one at least. When it is interrupted, or memory or disk are
// used up, the folder is left for --resume if anything is finished. Throws what simplify(), readMesh() and WorkFolder
// throw.
CellReport simplifyInCells(const hypermesh::File& file, Metric metric, const Options& options, const CellOptions& cells,
                           hypermesh::Writer& writer, outofcore::Executor& executor, outofcore::MemoryBudget& memory,
                           outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
