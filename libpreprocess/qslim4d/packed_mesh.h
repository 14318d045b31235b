// What is left of a mesh, in the order a file has it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

inline constexpr std::size_t kLeastPageTets = 16384;  // frames are joined until a page has so many
// A page is cut within a frame where else it would have more tetrahedra, or vertices of its own, than this: where
// little moves, most of a mesh begins in one frame.
inline constexpr std::size_t kMostPageItems = std::size_t{1} << 19;

// The mesh without what is dead: vertices by time, tetrahedra by their first vertex.
struct PackedMesh {
  std::vector<Vec4f> vertices;
  std::vector<hypermesh::Tet> tets;
  std::vector<std::uint64_t> first_tet;     // by vertex: the first tetrahedron whose least vertex is it or a later one
  std::vector<std::vector<float>> columns;  // as the mesh's, by vertex
  float error_estimated = 0;                // world units, for the page table
  float error_measured = -1;                // -1: not measured
};

// Uses `mesh` up: of one that is moved here no more is held than simplifying it took. O(tets + vertices log vertices).
PackedMesh pack(SlimMesh mesh);

// Bytes that pack() and writeMeshes() hold at most of a mesh that had so many vertices and tetrahedra.
std::uint64_t packBytes(std::uint64_t vertices, std::uint64_t tets);

// Writes the parts of a file (phase "write"), one for a file without parts: a page for one frame of a part, for
// several that have little, or for some of one that has much; pages of all parts by their first time. The writer has as
// many columns as each part and is not closed. Fewer than 2^32 vertices in all.
void writeMeshes(std::span<const PackedMesh> parts, hypermesh::Writer& writer, outofcore::Progress& progress);

// As above for a mesh that is the whole file; error_world: of the simplification, estimated.
void writeMesh(const SlimMesh& mesh, double error_world, hypermesh::Writer& writer, outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
