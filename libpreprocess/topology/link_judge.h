// Judges the links of vertices one at a time, in any order, and puts together what was found. Private to topology: the
// checks are in links.h.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libpreprocess/topology/links.h"

namespace tet4d::topology {

// The triangle opposite to a vertex in one of its tetrahedra: global numbers, in any order.
using LinkTriangle = std::array<std::uint64_t, 3>;

class LinkJudge {
 public:
  LinkJudge();
  LinkJudge(const LinkJudge&) = delete;
  LinkJudge& operator=(const LinkJudge&) = delete;
  ~LinkJudge();

  // Counts vertex v, its link (all triangles, not empty; reordered) and the edges to its neighbours of larger numbers.
  // may_bound: whether it may lie on the boundary. Each vertex once. O(n log n) for n triangles.
  void judge(std::uint64_t v, std::span<LinkTriangle> link, bool may_bound);
  // A tetrahedron with a repeated vertex; it belongs to no link.
  void degenerate(std::uint64_t tet);
  // The counts; faults in words are the first of each kind by vertex number, whatever the order of judging.
  // vertices: how many there are, used or not.
  LinkCheck result(std::uint64_t vertices);

 private:
  class VertexLink;
  struct Found {
    std::uint64_t vertex, other;  // of an edge; the largest number for the vertex itself
    std::string words;
  };
  static void keep(std::vector<Found>& found, std::uint64_t vertex, std::uint64_t other, const char* what);

  std::unique_ptr<VertexLink> link_;
  LinkCheck check_;
  std::vector<Found> edges_, vertices_;  // the first few, ascending
};

}  // namespace tet4d::topology
