// The CPU slicer: the triangle mesh M(t) = H ∩ P(t), from tetrahedra or from dynamic triangles.
//
// Slice vertices are welded by identity, not by distance: a vertex is the crossing of an edge (a, b), or, when t is
// exactly the time of an end, that end itself. A triangle two of whose corners are the same vertex is dropped. So a
// slice at a frame's time is the hull table's marching cubes of that frame, vertex for vertex, and slices between are
// closed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/core/tet_slice.h"
#include "formats/core/vec.h"

namespace tet4d {

// Identity of a slice vertex: the edge (a, b) it crosses, or (a, a) where the slice goes through vertex a.
struct SliceVertexKey {
  std::uint64_t a, b;
  friend bool operator==(const SliceVertexKey&, const SliceVertexKey&) = default;
  friend auto operator<=>(const SliceVertexKey&, const SliceVertexKey&) = default;
};

struct SliceMesh {
  std::vector<Vec3f> positions;                         // index space (cells)
  std::vector<SliceVertexKey> keys;                     // as many as positions
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
};

// Appends the slice of tetrahedra at time t (frames) to `mesh`. tets: indices into positions; ids[i]: the key space of
// vertex i (global numbers), or empty for i itself. last_t: the mesh's last time, at which lifespans are closed.
// Vertices are welded within one call. O(tets), memory O(output).
void sliceTets(std::span<const std::array<std::uint32_t, 4>> tets, std::span<const Vec4f> positions,
               std::span<const std::uint64_t> ids, float t, float last_t, SliceMesh& mesh);

// Area-weighted vertex normals of a slice (unit length; zero where all triangles at a vertex are degenerate).
std::vector<Vec3f> sliceNormals(const SliceMesh& mesh);

}  // namespace tet4d
