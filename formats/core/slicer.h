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
#include <utility>
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

// Slices tetrahedra piece by piece at one time; vertices are welded across the pieces, numbered in order of first use.
class TetSlicer {
 public:
  // t: frames; last_t: the mesh's last time, at which lifespans are closed.
  TetSlicer(float t, float last_t) : t_(t), last_t_(last_t) {}

  // tets: indices into positions; ids[i]: the key space of vertex i (global numbers), or empty for i itself.
  // O(tets), memory O(output).
  void add(std::span<const std::array<std::uint32_t, 4>> tets, std::span<const Vec4f> positions,
           std::span<const std::uint64_t> ids);

  const SliceMesh& mesh() const { return mesh_; }
  SliceMesh take() { return std::move(mesh_); }
  // By slice vertex: the ends of its edge, earlier first (one end twice where the slice goes through it), as indices
  // into the positions of the add() that made it.
  std::span<const std::array<std::uint32_t, 2>> ends() const { return ends_; }
  // By slice triangle: its tetrahedron's rank in the add() that made it.
  std::span<const std::uint32_t> tets() const { return tets_; }

 private:
  std::size_t slotOf(const SliceVertexKey& key) const;
  void grow();

  float t_, last_t_;
  SliceMesh mesh_;
  std::vector<std::array<std::uint32_t, 2>> ends_;
  std::vector<std::uint32_t> tets_;
  std::vector<std::uint32_t> slots_;  // open addressing; numbers of vertices, so that the table's order never shows
};

// Appends the slice of tetrahedra to `mesh`, as one add() of a TetSlicer. Vertices are welded within one call.
void sliceTets(std::span<const std::array<std::uint32_t, 4>> tets, std::span<const Vec4f> positions,
               std::span<const std::uint64_t> ids, float t, float last_t, SliceMesh& mesh);

// Area-weighted vertex normals of a slice (unit length; zero where all triangles at a vertex are degenerate).
std::vector<Vec3f> sliceNormals(const SliceMesh& mesh);

}  // namespace tet4d
