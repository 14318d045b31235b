// Builds the patches and the graph of a hypermesh at every resolution. Ponchio & Hormann 2008, sec. 6.
//
// In core: the mesh, and the patches until they are written. Deterministic: the result depends on the mesh and the
// options, not on threads.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/hypermesh.h"
#include "formats/patch_dag.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/vpartition/partition.h"
#include "libpreprocess/vpartition/patches.h"

namespace tet4d::vpartition {

struct Options {
  Kind partition = Kind::kVoronoi;
  std::uint64_t cell_tets = 200'000;  // of a cell that is simplified, on average
  std::uint64_t patch_tets = 8'000;   // of a patch, at most; up to kMostPatchTets
  double time_scale = 1;              // mean cells that a frame counts as; above 0
  std::uint64_t seed = 0;
};

// One level: a partition of the mesh that the level below left.
struct LevelReport {
  std::uint64_t cells = 0, stuck = 0;  // stuck: more than nine of ten tetrahedra were left
  std::uint64_t tets_in = 0, tets_out = 0;
  std::uint64_t largest_cell = 0, smallest_cell = 0;  // tetrahedra
  std::uint64_t vertices = 0, locked = 0;  // over the cells, one of several in each; locked: those of several
  std::uint64_t patches = 0;               // cut from what came in
  std::uint64_t orphans = 0;               // pieces that went to another cell
  double error_world = 0;                  // largest estimate of its nodes, those below counted
};

struct Dag {
  std::vector<patch_dag::NodeEntry> nodes;        // as a file has them, but for their patches
  std::vector<StoredPatch> patches;               // by upper node; nodes by their place in `nodes`
  std::vector<LevelReport> levels;                // the finest first
  std::uint64_t pruned_nodes = 0;                 // without error: what lies below them is left out
  std::uint64_t root_tets = 0, root_patches = 0;  // of the coarsest cut
};

// Throws Error{kUsage} for options out of range.
void checkOptions(const Options& options);

// Bytes it holds at most, as far as can be told before: a level's mesh, cells in flight, all patches.
std::uint64_t boundMemory(const hypermesh::File& file, const Options& options, std::size_t threads);

// Levels until what is left fits one patch, or nothing is left to take away (phases "read", "partition", "simplify").
// Throws Error{kBadInput} for a file of several parts, a mesh with a triangle in three tetrahedra, one of 2^32 - 2
// vertices or tetrahedra, and a mesh larger than a cell of which the first level takes less than a tenth away: such a
// graph would have one resolution. Error{kUsage}: options out of range. Error{kOutOfMemory} before it begins.
Dag buildDag(const hypermesh::File& file, const Options& options, outofcore::Executor& executor,
             outofcore::MemoryBudget& memory, outofcore::Progress& progress);

// Writes the patches (phase "write"); the writer is made with dag.nodes and not closed.
void writeDag(const Dag& dag, patch_dag::Writer& writer, outofcore::Progress& progress);

}  // namespace tet4d::vpartition
