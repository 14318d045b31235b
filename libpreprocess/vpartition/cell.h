// A cell of a partition while it is simplified: the task that is run for each, in any order and on any thread. Private
// to vpartition.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/qslim4d/simplify.h"

namespace tet4d::vpartition {

// All that lies in a cell, merged, with numbers of its own.
struct CellMesh {
  std::vector<std::uint64_t> ids;  // by vertex: its number in the whole mesh
  std::vector<Vec4f> positions;
  std::vector<std::uint8_t> flags;  // qslim4d::kLocked: other cells use the vertex too
  std::vector<hypermesh::Tet> tets;
};

// What is the same for all cells of a level.
struct CellRules {
  Bounds4f domain;
  AffineMap map;
  double speed = 1;  // of the whole mesh, see qslim4d::Space
};

struct CellResult {
  CellMesh mesh;  // what is left; vertices that no tetrahedron uses are gone. Numbers are those of the input's vertices
  std::uint64_t tets_in = 0, vertices_in = 0, locked = 0;
  double error_world = 0;  // of its own simplification, estimated
};

// A share of the tetrahedra that is left of a cell with that share of its vertices locked: half, and more where so much
// is locked that the rest would have to pay for it.
double wantedShare(double locked_share);

// Simplifies a cell with its locked vertices kept. Throws what makeSlimMesh() and simplify() throw.
CellResult simplifyCell(CellMesh cell, const CellRules& rules, outofcore::Executor& executor);

}  // namespace tet4d::vpartition
