// Simplification out of core: cells of bounded size, each simplified on its own, in sweeps whose cells are displaced.
// Ponchio & Hormann 2008, sec. 5 and 6.
//
// A sweep cuts the mesh by a k-d tree over barycentres, scatters it to files, and collapses edges within each cell.
// Vertices that several cells use are locked, so that every star a collapse touches is whole: what is judged in a cell
// holds for the mesh. The next sweep is cut elsewhere, with the quadrics of the one before; what was locked is inside
// there. The bytes depend on the mesh, the options and the size of cells; not on memory, threads or interrupts. Parts
// of a file are simplified one after the other, each in cells of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/simplify.h"

namespace tet4d::qslim4d {

inline constexpr std::uint64_t kCellTets = 8'000'000;

// What an independent measure says of a try.
struct Confirmation {
  double bound = 0;  // world units, see SliceBound
  double frame = 0;  // where it is largest, or where it broke
  bool within = false;
};

// A largest distance that is promised (promise.h): each part is simplified again under other estimates until
// `confirm` says that it is kept.
struct CellPromise {
  double world = 0;
  std::uint64_t most_tries = 8;
  // tried: a file of the part alone, without columns. broken_at: the frames at which earlier tries of the part broke,
  // in order: what breaks there again is found soonest. The answer depends on these alone.
  std::function<Confirmation(const hypermesh::File& tried, std::size_t part, std::span<const double> broken_at)>
      confirm;
};

struct CellOptions {
  std::uint64_t cell_tets = kCellTets;  // a cell has no more, as far as half a million samples tell
  std::string folder;                   // for temporary files; made, and removed at the end
  std::string run_name;                 // one line: the input's digest and what changes the result
  bool resume = false;                  // go on with what an interrupted run of that name left in the folder
  std::vector<std::uint64_t> targets;   // tetrahedra to be left, by part; empty: what the options say, for each
  std::vector<PlannedColumn> columns;   // to be carried, and in the metric: those of the writer
  bool keep_non_manifold = false;       // see lockNonManifold(); else a triangle in three tetrahedra is refused
  std::optional<CellPromise> promise;
};

struct SweepReport {
  std::uint64_t cells = 0, tets_in = 0, tets_out = 0;
};

struct CellReport {
  Stats stats;  // of all sweeps
  std::uint64_t vertices = 0, tets = 0, stalled_tets = 0;
  std::vector<SweepReport> sweeps;  // sums over parts
  std::size_t most_in_flight = 0;   // cells that were in memory at a time, at most
  bool is_resumed = false;          // it went on with what an interrupted run had left
  // Of what is no manifold, if it is kept: all but what lay between cells in every sweep, which stays as well.
  NonManifold non_manifold;
  // Of a promise: of all parts so far. Not kept: nothing is written, and `bound` is the least that broke it.
  bool is_kept = true;
  std::uint64_t tries = 0;
  double bound = 0, estimate = std::numeric_limits<double>::infinity();
};

// Bytes that a cell of `cell_tets` of this file takes at most, with what the program holds beside it: the least
// --memory that does, but for what confirming a promise takes. Temporary bytes on disk; promised: of tries, too.
std::uint64_t boundCellMemory(const hypermesh::File& file, std::uint64_t cell_tets,
                              std::span<const ColumnWish> columns = {});
std::uint64_t boundTemporaryBytes(const hypermesh::File& file, std::span<const ColumnWish> columns = {},
                                  bool promised = false);

// Simplifies `file` into `writer`, which is not closed (phases "read", "scatter", "simplify", "write"). As many cells
// are in flight as there are threads and `memory` allows, one at least. When it is interrupted, or memory or disk are
// used up, the folder is left for --resume if anything is finished. Throws what simplify(), readMesh() and WorkFolder
// throw.
CellReport simplifyInCells(const hypermesh::File& file, Metric metric, const Options& options, const CellOptions& cells,
                           hypermesh::Writer& writer, outofcore::Executor& executor, outofcore::MemoryBudget& memory,
                           outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
