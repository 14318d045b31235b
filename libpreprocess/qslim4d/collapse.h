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

  // False if an end is locked, or if the walls that the two ends stand on forbid the collapse whatever its place:
  // neither's are among the other's. Otherwise `placement` is filled in. Reads the two vertices only.
  bool evaluate(std::uint32_t u, std::uint32_t v, Placement& placement) const;

  // Of evaluate(), to many vertices from one.
  struct Priced {
    std::uint32_t other;
    double cost, error;
  };
  // Appends what evaluate() says of the edges from u to `others` where it allows them, two edges at a time. The same
  // numbers where the other end is larger than u, else but for rounding.
  void price(std::uint32_t u, std::span<const std::uint32_t> others, std::vector<Priced>& priced) const;

  // The whole test at a place that evaluate() gave: link condition of 3-complexes with boundary (Dey et al. 1999, the
  // boundary coned to one more vertex), no spatial normal turned by more than 75 degrees, no new tetrahedron of four
  // equal times or without volume, the star's size. O(stars).
  Verdict judge(std::uint32_t u, std::uint32_t v, const Vec4f& at);

  // Collapses u and v into u at `at`. The edge must have been judged kAllowed. O(stars). Returns the number of
  // tetrahedra removed; the mesh's counts are the caller's to update. Not beside other threads: it may make room.
  std::uint32_t collapse(std::uint32_t u, std::uint32_t v, const Vec4f& at);
  // The same right after judge() of this edge, with no other call between them, where makeRoom() has been called before
  // for the stars of all that collapse meanwhile.
  std::uint32_t merge(std::uint32_t u, std::uint32_t v, const Vec4f& at);

  // The vertices that share a tetrahedron with v, each once, in order of first use. Valid until the next call.
  std::span<const std::uint32_t> neighbours(std::uint32_t v);

 private:
  using Edge = std::uint64_t;  // smaller vertex in the high half
  using Face = std::array<std::uint32_t, 3>;
  struct Corner {
    hypermesh::Tet tet;
    std::uint32_t number;  // 4 * tetrahedron + the vertex's place in it
  };
  void gatherSecond(std::uint32_t u, std::uint32_t v);
  void unite(std::uint32_t u, std::uint32_t v, const Vec4f& at);
  void gatherApart(std::uint32_t v, std::uint32_t other, std::vector<Corner>& apart) const;
  bool linksAllow();
  void sharedPieces(const std::vector<Corner>& apart, std::vector<Edge>& edges, std::vector<Face>& faces);
  void readBorder(const std::vector<Corner>& apart, std::uint32_t other, std::vector<Edge>& border) const;
  bool bordersAllow(std::uint32_t u, std::uint32_t v);
  Verdict judgeStar(const std::vector<Corner>& apart, const Vec4f& from, const Vec4f& at) const;

  SlimMesh* mesh_;
  CollapseRules rules_;
  VertexMarks marks_;
  // Of the edge that is looked at: tetrahedra at u without v, at v without u, and the edge's link.
  std::vector<Corner> apart_u_, apart_v_;
  std::vector<Edge> link_edges_;
  std::vector<std::uint32_t> link_tets_;  // those with both ends
  std::vector<Edge> edges_u_, edges_v_, border_u_, border_v_;
  std::vector<Face> faces_u_, faces_v_;
  std::vector<std::uint32_t> neighbours_;
};

}  // namespace tet4d::qslim4d
