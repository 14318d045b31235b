// One edge collapse: where its vertex would go, whether that is allowed, and doing it. Private to qslim4d.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/qslim4d/placement.h"
#include "libpreprocess/qslim4d/slim_mesh.h"
#include "libpreprocess/qslim4d/vertex_marks.h"

namespace tet4d::qslim4d {

// Why a collapse is not allowed.
enum class Verdict { kAllowed, kWalls, kLinks, kFlip, kFlatTime, kStar };

struct CollapseRules {
  double align = 0.25;           // see placeVertex()
  bool frames = true;            // see placeVertex()
  std::uint32_t most_star = 80;  // tetrahedra at the new vertex, at most
};

// Judges and performs collapses; keeps its scratch lists between calls. Several may work on one mesh at a time as long
// as no end of one edge is an end or a neighbour of an end of another: what one writes no other reads.
class Collapser {
 public:
  Collapser(SlimMesh& mesh, const CollapseRules& rules) : mesh_(&mesh), rules_(rules) {}

  // False if the walls that the two ends stand on forbid the collapse whatever its place, neither's being among the
  // other's, or if an end is locked. Otherwise `placement` is filled in. Reads the two vertices only.
  bool evaluate(std::uint32_t u, std::uint32_t v, Placement& placement) const;

  // The whole test at a place that evaluate() gave: link condition of 3-complexes with boundary (Dey et al. 1999, the
  // boundary coned to one more vertex), no spatial normal turned by more than 75 degrees, no new tetrahedron of four
  // equal times or without volume, the star's size. O(stars).
  Verdict judge(std::uint32_t u, std::uint32_t v, const Vec4f& at);

  // Collapses u and v into u at `at`. The edge must have been judged kAllowed. O(star of v). Returns the number of
  // tetrahedra removed; the mesh's counts are the caller's to update.
  std::uint32_t collapse(std::uint32_t u, std::uint32_t v, const Vec4f& at);

  // The vertices that share a tetrahedron with v, each once, in order of first use. Valid until the next call.
  std::span<const std::uint32_t> neighbours(std::uint32_t v);

 private:
  using Edge = std::uint64_t;  // smaller vertex in the high half
  using Face = std::array<std::uint32_t, 3>;
  bool linksAllow(std::uint32_t u, std::uint32_t v);
  void sharedPieces(std::uint32_t v, std::uint32_t other, std::vector<Edge>& edges, std::vector<Face>& faces);
  void readBorder(std::uint32_t v, std::vector<Edge>& border) const;
  bool bordersAllow(std::uint32_t u, std::uint32_t v);
  Verdict judgeStar(std::uint32_t v, std::uint32_t other, const Vec4f& at) const;
  std::uint32_t starSize(std::uint32_t v) const;

  SlimMesh* mesh_;
  CollapseRules rules_;
  VertexMarks marks_;
  std::vector<Edge> link_edges_;  // the link of the edge uv
  std::vector<Edge> edges_u_, edges_v_, border_u_, border_v_;
  std::vector<Face> faces_u_, faces_v_;
  std::vector<std::uint32_t> neighbours_;
};

}  // namespace tet4d::qslim4d
