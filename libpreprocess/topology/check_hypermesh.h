// Proof that a hypermesh file is one consistently oriented 3-manifold away from its legal boundary, face by face.
//
// Every triangle must lie in exactly two tetrahedra that induce opposite orientations on it. A triangle in one
// tetrahedron is boundary: legal on a wall of header.domain (all three vertices share the wall's coordinate: x, y, z or
// t, smallest or largest), and inside only if the file says kInnerBoundary or is not kOnGrid. Ponchio & Hormann 2008,
// sec. 3. The test of vertex and edge links is in links.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::topology {

struct HypermeshCheck {
  std::uint64_t tets = 0, vertices = 0;
  std::uint64_t inner_faces = 0;           // triangles in exactly two tetrahedra
  std::uint64_t wall_faces = 0;            // in one tetrahedron, on a wall of the domain
  std::uint64_t inner_boundary_faces = 0;  // in one tetrahedron, elsewhere
  std::uint64_t faces_over_two = 0;        // in three or more: a fault
  std::uint64_t misoriented_faces = 0;     // of inner_faces: both tetrahedra induce the same orientation, a fault
  // Without 3-volume: legal, but of no use. (A tetrahedron that names a vertex twice is refused when its page is read.)
  std::uint64_t degenerate_tets = 0;
  // All four vertices at one time: legal, for a surface may jump (a sample that is 0, then 1 in a whole region), but in
  // no slice.
  std::uint64_t flat_time_tets = 0;
  std::uint64_t unused_vertices = 0;  // in no tetrahedron: legal, but tells of a wasteful writer
  std::uint64_t most_open_faces = 0;  // largest front carried from one page to the next: what the pass holds
  std::vector<std::string> faults;    // the first few of each kind in words; the counts are exact
  bool ok() const { return faults.empty(); }
};

// Reads the file twice, page by page in order (phases "reach" and "faces"). Memory: one gathered page, 64 bytes a
// tetrahedron of it, and the faces that a later page can still meet. O(file). Throws Error where a page is damaged
// (checksum, index out of range) or on interrupt; faults of the mesh are returned, not thrown. If `memory` is given,
// all of that is reserved from it: Error{kOutOfMemory} where a page or the front does not fit.
HypermeshCheck checkHypermesh(const hypermesh::File& file, outofcore::Progress& progress,
                              outofcore::MemoryBudget* memory = nullptr);

}  // namespace tet4d::topology
