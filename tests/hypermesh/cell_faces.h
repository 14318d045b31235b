// The triangles a cell's tetrahedra leave in one of its eight walls: what the neighbour across that wall must match.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "libpreprocess/hypermesh/cell_table.h"

namespace tet4d::hypermesh::testing {

// A triangle by the (axis mask, base corner) of its edges, ascending, and whether its winding is an odd permutation of
// that.
struct FaceTriangle {
  std::array<int, 3> edges;
  bool odd;
  friend auto operator<=>(const FaceTriangle&, const FaceTriangle&) = default;
};

inline FaceTriangle sortedTriangle(std::array<int, 3> edges, bool odd) {
  for (const auto& [i, j] : {std::pair{0U, 1U}, std::pair{1U, 2U}, std::pair{0U, 1U}})
    if (edges[i] > edges[j]) std::swap(edges[i], edges[j]), odd = !odd;
  return {edges, odd};
}

// The oriented boundary triangles of a tetrahedron: face i is opposite vertex i.
template <class Index>
std::array<std::array<Index, 3>, 4> facesOf(const std::array<Index, 4>& t) {
  return {{{t[1], t[2], t[3]}, {t[0], t[3], t[2]}, {t[0], t[1], t[3]}, {t[0], t[2], t[1]}}};
}

// Sorted triangles of `configuration` in the wall `axis` = side (0 or 1), edges as if the wall were side 0.
inline std::vector<FaceTriangle> wallTriangles(const CellTable& table, unsigned configuration, unsigned axis,
                                               unsigned side) {
  const auto edgeInWall = [&](std::uint8_t number) {
    const CellEdge edge = table.edges[number];
    if (edge.direction >> axis & 1U || (edge.base >> axis & 1U) != side) return -1;
    return edge.direction * 16 + (edge.base & ~(1 << axis));
  };
  std::vector<FaceTriangle> out;
  for (const CellTet& tet : table.of(configuration)) {
    for (const auto& face : facesOf(tet)) {
      const std::array<int, 3> edges{edgeInWall(face[0]), edgeInWall(face[1]), edgeInWall(face[2])};
      if (std::none_of(edges.begin(), edges.end(), [](int e) { return e < 0; }))
        out.push_back(sortedTriangle(edges, false));
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The eight signs in a wall as a number, corners ascending.
inline unsigned wallSigns(unsigned configuration, unsigned axis, unsigned side) {
  unsigned signs = 0, bit = 0;
  for (unsigned corner = 0; corner < 16; ++corner)
    if ((corner >> axis & 1U) == side) signs |= (configuration >> corner & 1U) << bit++;
  return signs;
}

}  // namespace tet4d::hypermesh::testing
