// A hypermesh file as a mesh in core, and back.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

inline constexpr std::size_t kLeastPageTets = 16384;  // frames are joined until a page has so many

// Bytes that simplifying a mesh in core holds at most.
std::uint64_t simplifyBytes(std::uint64_t vertices, std::uint64_t tets);

// Throws Error{kBadInput} if `file` has several parts.
void refuseParts(const hypermesh::File& file);

// Bytes that simplifying `file` holds at most: the mesh, its edges, and the pages as they are read.
std::uint64_t boundMemory(const hypermesh::File& file);

// The whole of `file` (phase "read"). Throws Error{kBadInput} if it has several parts, or 2^32 - 1 vertices or 2^30
// tetrahedra and more; Error of a damaged page; what makeSlimMesh() throws.
SlimMesh readMesh(const hypermesh::File& file, Metric metric, outofcore::Progress& progress);

// Writes what is left of `mesh`, vertices by time, a page for one frame or for several that have little (phase
// "write"). error_world: of the simplification, for the page table. The writer is not closed.
void writeMesh(const SlimMesh& mesh, double error_world, hypermesh::Writer& writer, outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
