// A tetrahedral mesh that edges are collapsed in: positions, tetrahedra, and the star of every vertex as a linked list
// through the tetrahedra's corners. Private to qslim4d.
//
// Memory: 32 bytes a tetrahedron, 157 bytes a vertex. Merging two stars is O(1); dead corners leave a list the next
// time it is tidied.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/qslim4d/quadric.h"
#include "libpreprocess/qslim4d/space.h"

namespace tet4d::qslim4d {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Walls of the domain a vertex stands on: bit 2c for the low side of coordinate c (x y z t), 2c + 1 for the high one.
using Walls = std::uint8_t;

enum class Metric {
  kSlice,  // squared spatial distance at fixed time, weighted by swept area
  kPaper,  // sum of N N^T with the raw 4D cross product N
};

// What is known of a vertex beside its walls, or-ed together.
enum VertexFlags : std::uint8_t {
  kOnBoundary = 1,  // it lies in a triangle of one tetrahedron
  kLocked = 2,      // tetrahedra outside this mesh use it: it stays as it is
  kUncounted = 4,   // it was locked whenever free boundaries were looked for so far
};

struct SlimMesh {
  std::vector<Vec4f> positions;      // index space
  std::vector<hypermesh::Tet> tets;  // a dead one has kNone as its first vertex
  std::vector<std::uint32_t> next;   // by corner 4 * tet + i: the next corner at the same vertex, or kNone
  std::vector<std::uint32_t> head;   // by vertex: its first corner; kNone: dead or unused
  std::vector<std::uint32_t> tail;   // by vertex: its last corner
  std::vector<Quadric> quadrics;     // by vertex, about the vertex
  std::vector<Walls> walls;
  std::vector<std::uint8_t> is_boundary;  // VertexFlags
  std::uint64_t live_tets = 0, live_vertices = 0;
  Space space;

  bool isLive(std::uint32_t tet) const { return tets[tet][0] != kNone; }

  // Calls visit(tet, corner) for the living tetrahedra at v.
  template <class Visit>
  void forEachTet(std::uint32_t v, const Visit& visit) const {
    for (std::uint32_t c = head[v]; c != kNone; c = next[c]) {
      if (isLive(c / 4)) visit(c / 4, c % 4);
    }
  }
};

// Of a mesh that is a cell of a larger one (cells.h): what it brings along.
struct CellContext {
  std::span<const std::uint8_t> flags;   // by vertex: kLocked and kUncounted
  std::span<const Quadric> quadrics;     // by vertex, from before; empty: they are made from the tetrahedra
  std::span<const std::uint64_t> names;  // by vertex: its number in the larger mesh, for messages
  double speed = 1;                      // of the larger mesh, see Space
};

// The mesh of these vertices and tetrahedra with stars, walls of `domain`, boundary and quadrics. Throws
// Error{kBadInput} that names the triangle if one lies in more than two tetrahedra (the link condition has no meaning
// there). O(tets log star). cell: the mesh is a part of a larger one; a triangle of locked vertices in one tetrahedron
// is where it was cut, and no boundary.
SlimMesh makeSlimMesh(std::vector<Vec4f> positions, std::vector<hypermesh::Tet> tets, const Bounds4f& domain,
                      const AffineMap& map, Metric metric, const CellContext* cell = nullptr);

// Mean reach of the tetrahedra's edges in space over that in time, from their sums; 1 if either is 0.
double speedFrom(double space, double time);

// Bytes of a mesh of so many vertices and tetrahedra, with what building it takes.
std::uint64_t slimMeshBytes(std::uint64_t vertices, std::uint64_t tets);

}  // namespace tet4d::qslim4d
