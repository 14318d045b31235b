// A tetrahedral mesh that edges are collapsed in: positions, tetrahedra, and the star of every vertex as a run of
// corners in one pool. Private to qslim4d.
//
// Memory: 33 bytes a tetrahedron, 154 bytes a vertex. A merged star is written anew at the pool's end; dead corners
// stay in the stars of others until the pool is laid out again.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/huge_pages.h"
#include "libpreprocess/qslim4d/columns.h"
#include "libpreprocess/qslim4d/quadric.h"
#include "libpreprocess/qslim4d/space.h"

namespace tet4d::qslim4d {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Where the spatial part of a tetrahedron's normal is below this share of its temporal part, the surface stands almost
// parallel to the present (births, jumps): a fixed-time distance has no meaning there, and its weight is bounded.
inline constexpr double kLeastSlope = 0.05;

// Walls of the domain a vertex stands on: bit 2c for the low side of coordinate c (x y z t), 2c + 1 for the high one.
using Walls = std::uint8_t;

enum class Metric {
  kSlice,  // squared spatial distance at fixed time, weighted by swept area
  kPaper,  // sum of N N^T with the raw 4D cross product N
};

// What is known of a vertex beside its walls, or-ed together.
enum VertexFlags : std::uint8_t {
  kOnBoundary = 1,  // it lies in a triangle of one tetrahedron
  kLocked = 2,      // it keeps its place, and no edge at it is collapsed
  kUncounted = 4,   // it was locked whenever free boundaries were looked for so far
  kPinned = 8,      // locked because the mesh is no manifold there
};

// An empty list in place of `items`, whose memory goes back; assigning {} would keep it.
template <class Items>
void release(Items& items) {
  items = Items();
}

// Where a vertex's corners stand in SlimMesh::corners; none: the vertex is dead or unused.
struct Star {
  std::uint32_t begin = 0;
  std::uint32_t size = 0;
};

struct SlimMesh {
  std::vector<Vec4f> positions;                                      // index space
  std::vector<hypermesh::Tet> tets;                                  // a dead one has kNone as its first vertex
  std::vector<std::uint32_t> corners;                                // 4 * tet + i: vertex i of tet
  std::uint64_t corners_used = 0;                                    // of `corners`
  std::vector<Star> stars;                                           // by vertex
  std::vector<Quadric, outofcore::LineAllocator<Quadric>> quadrics;  // by vertex, about the vertex
  std::vector<Walls> walls;
  std::vector<std::uint8_t> is_boundary;  // by vertex: VertexFlags
  Columns columns;                        // values at the vertices; takes nothing where there are none
  std::uint64_t live_tets = 0, live_vertices = 0;
  Space space;
  Bounds4f domain;  // no vertex leaves it, index space

  bool isLive(std::uint32_t tet) const { return tets[tet][0] != kNone; }
  // A vertex whose last tetrahedron died with others' edges still counts as used until the stars are laid out again.
  bool isUsed(std::uint32_t v) const { return stars[v].size != 0; }

  // Brings what a walk over v's star reads into the cache.
  void prefetchStar(std::uint32_t v) const {
    for (const std::uint32_t c : starOf(v)) __builtin_prefetch(&tets[c / 4]);
  }

  // The corners at v, dead ones among them.
  std::span<const std::uint32_t> starOf(std::uint32_t v) const {
    return {corners.data() + stars[v].begin, stars[v].size};
  }

  // Calls visit(tet, corner) for the living tetrahedra at v.
  template <class Visit>
  void forEachTet(std::uint32_t v, const Visit& visit) const {
    for (const std::uint32_t c : starOf(v)) {
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

// What a mesh is made with beside its arrays.
struct MeshContext {
  bool keep_non_manifold = false;           // a triangle of more than two tetrahedra is no refusal
  outofcore::Executor* executor = nullptr;  // who looks for the boundary; without one, the caller
  const CellContext* cell = nullptr;        // the mesh is a part of a larger one; a triangle of locked vertices
                                            // in one tetrahedron is where it was cut, and no boundary
};

// The mesh of these vertices and tetrahedra with stars, walls of `domain`, boundary and quadrics. Throws
// Error{kBadInput} that names the triangle if one lies in more than two tetrahedra (the link condition has no meaning
// there), unless keep_non_manifold: lockNonManifold() must follow. O(tets log star).
SlimMesh makeSlimMesh(std::vector<Vec4f> positions, std::vector<hypermesh::Tet> tets, const Bounds4f& domain,
                      const AffineMap& map, Metric metric, const MeshContext& context = {});

// Drops dead tetrahedra, which gives those that are left new numbers, and lays all stars out again, in order of
// vertices and tetrahedra. O(tets).
void tidy(SlimMesh& mesh);

// Corners that may be written between two makeRoom(), for each living one: slimMeshBytes() counts on no more.
inline constexpr std::uint64_t kMostNewShare = 4;

// Makes room for `count` more corners, by tidy() if there is none.
void makeRoom(SlimMesh& mesh, std::uint64_t count);

// Mean reach of the tetrahedra's edges in space over that in time, from their sums; 1 if either is 0.
double speedFrom(double space, double time);

// Bytes of a mesh of so many vertices and tetrahedra, with what building it takes.
std::uint64_t slimMeshBytes(std::uint64_t vertices, std::uint64_t tets);

}  // namespace tet4d::qslim4d
