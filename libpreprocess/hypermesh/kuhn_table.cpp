#include "libpreprocess/hypermesh/kuhn_table.h"

#include <algorithm>

namespace tet4d::hypermesh {
namespace {

using Pentatope = std::array<std::uint8_t, 5>;  // corners along the walk, each with one axis more than the last

std::array<int, 4> subtract(const std::array<int, 4>& a, const std::array<int, 4>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
}

struct KuhnTable {
  std::vector<CellEdge> edges;
  std::vector<EdgeDirection> directions;
  std::array<std::uint8_t, 16> direction_of;  // by axis mask
  std::vector<std::uint32_t> offsets{0};
  std::vector<CellTet> tets;
  CellTable table;

  KuhnTable() {
    std::vector<std::uint8_t> axis_masks;
    for (std::uint8_t axes = 1; axes < 16; ++axes) {
      direction_of[axes] = static_cast<std::uint8_t>(axis_masks.size());
      axis_masks.push_back(axes);
    }
    directions = numberEdges(axis_masks, edges);
    fill();
    table = {directions, edges, offsets, tets, 0};
    for (unsigned c = 0; c < kConfigurations; ++c) table.max_tets = std::max(table.max_tets, table.count(c));
  }

  void fill() {
    const std::vector<Pentatope> pentatopes = allPentatopes();
    std::vector<std::array<std::vector<CellTet>, 32>> split(pentatopes.size());
    for (std::size_t p = 0; p < pentatopes.size(); ++p)
      for (unsigned signs = 0; signs < 32; ++signs) split[p][signs] = splitPentatope(pentatopes[p], signs);
    tets.reserve(3'440'640);  // all of them: growing would hold the table twice
    for (unsigned configuration = 0; configuration < kConfigurations; ++configuration) {
      for (std::size_t p = 0; p < pentatopes.size(); ++p) {
        unsigned signs = 0;
        for (unsigned i = 0; i < 5; ++i) signs |= (configuration >> pentatopes[p][i] & 1u) << i;
        tets.insert(tets.end(), split[p][signs].begin(), split[p][signs].end());
      }
      offsets.push_back(static_cast<std::uint32_t>(tets.size()));
    }
  }

  static std::vector<Pentatope> allPentatopes() {
    std::vector<Pentatope> all;
    std::array<unsigned, 4> order{0, 1, 2, 3};
    do {
      Pentatope walk{};
      for (std::size_t i = 0; i < 4; ++i) walk[i + 1] = static_cast<std::uint8_t>(walk[i] | 1u << order[i]);
      all.push_back(walk);
    } while (std::next_permutation(order.begin(), order.end()));
    return all;
  }

  // Number of the edge between two corners of a walk.
  std::uint8_t edgeBetween(std::uint8_t a, std::uint8_t b) const {
    const auto base = std::min(a, b);
    return directions[direction_of[a ^ b]].number[base];
  }
  int rank(std::uint8_t edge) const { return pullingRank(edges[edge]); }

  // Positive if the inside corner lies on the negative side of the tetrahedron's hyperplane.
  CellTet oriented(CellTet tet, std::uint8_t inside_corner) const {
    const auto a = doubledMidpoint(edges[tet[0]]);
    std::array<std::array<int, 4>, 4> rows{subtract(doubledMidpoint({0, inside_corner}), a)};
    for (std::size_t k = 1; k < 4; ++k) rows[k] = subtract(doubledMidpoint(edges[tet[k]]), a);
    if (determinant4(rows) > 0) std::swap(tet[2], tet[3]);
    return tet;
  }

  std::vector<CellTet> splitPentatope(const Pentatope& corners, unsigned signs) const {
    std::vector<std::uint8_t> inside, outside;
    for (unsigned i = 0; i < 5; ++i) (signs >> i & 1u ? inside : outside).push_back(corners[i]);
    if (inside.empty() || outside.empty()) return {};
    // Rows of the cell: the smaller side's corners; columns: the other's. One row is a tetrahedron, two are a prism.
    auto& rows = inside.size() <= outside.size() ? inside : outside;
    auto& columns = inside.size() <= outside.size() ? outside : inside;
    std::vector<CellTet> out;
    if (rows.size() == 1) {
      CellTet tet{};
      for (std::size_t i = 0; i < 4; ++i) tet[i] = edgeBetween(rows[0], columns[i]);
      out.push_back(oriented(tet, inside[0]));
    } else {
      splitPrism(rows, columns, inside[0], out);
    }
    return out;
  }

  void splitPrism(const std::vector<std::uint8_t>& rows, const std::vector<std::uint8_t>& columns,
                  std::uint8_t inside_corner, std::vector<CellTet>& out) const {
    std::array<std::array<std::uint8_t, 3>, 2> v{};
    std::size_t low_row = 0, low_column = 0;
    for (std::size_t r = 0; r < 2; ++r)
      for (std::size_t c = 0; c < 3; ++c) {
        v[r][c] = edgeBetween(rows[r], columns[c]);
        if (rank(v[r][c]) < rank(v[low_row][low_column])) low_row = r, low_column = c;
      }
    const std::uint8_t apex = v[low_row][low_column];
    const auto& far = v[1 - low_row];
    out.push_back(oriented({apex, far[0], far[1], far[2]}, inside_corner));
    // The one quadrilateral without the apex: columns i and j. Its lowest corner sends the diagonal.
    const std::size_t i = (low_column + 1) % 3, j = (low_column + 2) % 3;
    const std::array<std::uint8_t, 4> quad{v[0][i], v[0][j], v[1][j], v[1][i]};
    std::size_t low = 0;
    for (std::size_t k = 1; k < 4; ++k)
      if (rank(quad[k]) < rank(quad[low])) low = k;
    const auto at = [&](std::size_t k) { return quad[(low + k) % 4]; };
    out.push_back(oriented({apex, at(0), at(1), at(2)}, inside_corner));
    out.push_back(oriented({apex, at(0), at(2), at(3)}, inside_corner));
  }
};

}  // namespace

const CellTable& kuhnTable() {
  static const KuhnTable instance;
  return instance.table;
}

}  // namespace tet4d::hypermesh
