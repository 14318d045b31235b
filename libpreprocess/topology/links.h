// The link test: what the face test cannot see. A mesh whose triangles all lie in two tetrahedra can still touch itself
// in a vertex or an edge; it is a 3-manifold if and only if every vertex's link is a sphere, or a disc on the boundary.
//
// The link of a vertex is made of the triangles opposite to it in its tetrahedra; the link of an edge, of the edges
// opposite to it. A file is streamed: a vertex is judged when the last page that uses it has been read.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::topology {

struct LinkCheck {
  std::uint64_t vertices = 0;         // in at least one tetrahedron
  std::uint64_t unused_vertices = 0;  // in none
  std::uint64_t sphere_links = 0;     // inner vertices
  std::uint64_t disc_links = 0;       // boundary vertices, legal
  std::uint64_t faulty_vertices = 0;  // link neither, or a disc where no boundary may be
  std::uint64_t edges = 0;            // of the mesh
  std::uint64_t cycle_edges = 0;      // link one cycle: inner edges
  std::uint64_t path_edges = 0;       // link one path: boundary edges
  std::uint64_t faulty_edges = 0;     // link neither
  std::uint64_t degenerate_tets = 0;  // with a repeated vertex: a fault, left out of the links
  std::uint64_t largest_star = 0;     // most tetrahedra at one vertex
  std::uint64_t most_open = 0;        // of a file: largest front carried from one page to the next, in corners
  std::vector<std::string> faults;    // the first few of each kind in words; the counts are exact
  bool ok() const { return faults.empty(); }
};

// Checks the links of vertices 0 .. vertices - 1. Every vertex link must be connected, have each of its edges in two
// triangles (one at a boundary), no triangle twice, one cycle or one path around each of its vertices, and Euler
// characteristic 2 (1 at a boundary). boundary_allowed: whether any vertex may lie on a boundary.
// In core. Fewer than 2^32 of either. O(tets log largest star), memory 16 bytes a tetrahedron and 8 a vertex beside the
// input.
// Throws Error{kBadInput} where a tetrahedron names a vertex that is not there.
LinkCheck checkLinks(std::span<const hypermesh::Tet> tets, std::uint64_t vertices, bool boundary_allowed);

// As above; may_bound[v] is not 0 if vertex v may lie on the boundary. may_bound.size() is the number of vertices.
LinkCheck checkLinks(std::span<const hypermesh::Tet> tets, std::span<const std::uint8_t> may_bound);

// Checks a file's links, page by page in order (phases "reach" and "links"); same result as for its index list as an
// array. Boundary is allowed at vertices on the walls of the domain, and everywhere if the file says kInnerBoundary or
// is not kOnGrid. Memory, all reserved from `memory`: one gathered page with 16 bytes a vertex and 16 a tetrahedron,
// and the open front, 32 bytes for every corner at a vertex that a later page still uses. O(file log). Throws
// Error{kOutOfMemory} where that does not fit, and Error of a damaged page.
LinkCheck checkLinks(const hypermesh::File& file, outofcore::MemoryBudget& memory, outofcore::Progress& progress);

}  // namespace tet4d::topology
