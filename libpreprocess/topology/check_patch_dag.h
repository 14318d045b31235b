// Whether every cut of a patch DAG is closed. Ponchio & Hormann 2008, sec. 6.
//
// Refining a node replaces the patches that end in it with those that come from it. If both have the same boundary, as
// chains of oriented triangles named by the bits of their corners, every legal cut has the boundary of the source's:
// by induction over the nodes that are refined. Triangles on a wall of the domain are left out, for cells are
// simplified within walls. What is proved holds for all cuts, however many, and so do slices of them at any time.
//
// A mesh with an inner boundary is simplified there too. Then what changes in a node must be boundary of the whole mesh
// at the node's level, or at the one below: a crack is boundary of neither.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/patch_dag.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::topology {

struct PatchDagCheck {
  std::uint64_t nodes = 0;          // compared: all but source and sink
  std::uint64_t cracked_nodes = 0;  // whose refinement tears the mesh
  std::uint64_t crack_faces = 0;    // triangles where it does
  std::uint64_t open_faces = 0;     // boundary of the source's cut away from walls: an inner boundary, or a fault
  std::vector<std::string> faults;  // the first few of each kind
};

// Reads every patch twice (phase "patches"), those of a mesh with an inner boundary four times. On a grid without inner
// boundary open faces are a fault. O(tets log tets); memory 64 bytes a face of the largest node's patches, with an
// inner boundary of those of the largest level.
PatchDagCheck checkPatchDag(const patch_dag::File& file, outofcore::MemoryBudget& memory,
                            outofcore::Progress& progress);

}  // namespace tet4d::topology
