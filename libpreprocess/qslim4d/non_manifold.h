// Places of a mesh that are no manifold, left exactly as they are.
#pragma once

#include <cstdint>

#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

struct NonManifold {
  std::uint64_t triangles = 0;  // in more than two tetrahedra
  std::uint64_t vertices = 0;   // whose link is neither a sphere nor a disc; corners of such triangles among them
};

// Locks every vertex whose link is neither a sphere nor a disc. Collapses elsewhere keep the links of all vertices up
// to homeomorphism: both ends are manifold, and the link condition then contracts, in the link of a third vertex, an
// edge between two points of a surface. So no new such place comes up and none goes. O(tets log star).
//
// In a cell of a larger mesh, vertices that are locked already are passed over: their stars are not whole here. What is
// found is counted if `first`, or if the vertex has been locked in every sweep before (kUncounted).
NonManifold lockNonManifold(SlimMesh& mesh, bool first = true);

}  // namespace tet4d::qslim4d
