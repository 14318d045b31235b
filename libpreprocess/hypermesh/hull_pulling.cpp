// Facets to tetrahedra by pulling, and the table's bytes.
#include <algorithm>
#include <bit>
#include <cstring>

#include "libpreprocess/hypermesh/hull_facets.h"

namespace tet4d::hypermesh {
namespace {

// Midpoints of the edges that lie in each of the cell's eight walls.
std::array<std::uint32_t, 8> wallMasks() {
  std::array<std::uint32_t, 8> walls{};
  for (std::size_t e = 0; e < 32; ++e) {
    const auto point = doubledMidpoint(hullEdges()[e]);
    for (std::size_t axis = 0; axis < 4; ++axis) {
      if (point[axis] == 0) walls[axis * 2] |= 1u << e;
      if (point[axis] == 2) walls[axis * 2 + 1] |= 1u << e;
    }
  }
  return walls;
}

std::uint8_t lowest(std::uint32_t edges) {
  static const std::array<int, 32> ranks = [] {
    std::array<int, 32> out{};
    for (std::size_t e = 0; e < 32; ++e) out[e] = pullingRank(hullEdges()[e]);
    return out;
  }();
  int best = std::countr_zero(edges);
  for (std::uint32_t rest = edges; rest; rest &= rest - 1) {
    const int e = std::countr_zero(rest);
    if (ranks[static_cast<std::size_t>(e)] < ranks[static_cast<std::size_t>(best)]) best = e;
  }
  return static_cast<std::uint8_t>(best);
}

bool has(std::uint32_t edges, std::uint8_t e) { return edges >> e & 1u; }

CellTet oriented(CellTet tet, const std::array<std::int16_t, 4>& normal) {
  const auto a = doubledMidpoint(hullEdges()[tet[0]]);
  std::array<std::array<int, 4>, 4> rows{};
  for (std::size_t i = 0; i < 4; ++i) rows[0][i] = normal[i];
  for (std::size_t k = 1; k < 4; ++k) {
    const auto p = doubledMidpoint(hullEdges()[tet[k]]);
    for (std::size_t i = 0; i < 4; ++i) rows[k][i] = p[i] - a[i];
  }
  if (determinant4(rows) < 0) std::swap(tet[2], tet[3]);
  return tet;
}

// The 2-faces of a facet: where it meets the other facets and the walls. Every midpoint is a vertex of the hull, so
// three common points are never on a line and span a polygon.
std::vector<std::uint32_t> polygonsOf(std::size_t facet, std::span<const HullFacet> facets) {
  static const std::array<std::uint32_t, 8> walls = wallMasks();
  const std::uint32_t edges = facets[facet].edges;
  std::vector<std::uint32_t> polygons;
  for (std::size_t other = 0; other < facets.size(); ++other)
    if (other != facet && std::popcount(edges & facets[other].edges) >= 3)
      polygons.push_back(edges & facets[other].edges);
  for (const std::uint32_t wall : walls)
    if (std::popcount(edges & wall) >= 3) polygons.push_back(edges & wall);
  return polygons;
}

void pullFacet(std::size_t facet, std::span<const HullFacet> facets, std::vector<CellTet>& tets) {
  const std::vector<std::uint32_t> polygons = polygonsOf(facet, facets);
  const std::uint8_t apex = lowest(facets[facet].edges);
  for (const std::uint32_t polygon : polygons) {
    if (has(polygon, apex)) continue;
    const std::uint8_t fan = lowest(polygon);
    for (const std::uint32_t neighbour : polygons) {
      const std::uint32_t side = polygon & neighbour;
      if (neighbour == polygon || std::popcount(side) != 2 || has(side, fan)) continue;
      const auto b = static_cast<std::uint8_t>(std::countr_zero(side));
      const auto c = static_cast<std::uint8_t>(31 - std::countl_zero(side));
      tets.push_back(oriented({apex, fan, b, c}, facets[facet].normal));
    }
  }
}

}  // namespace

std::vector<CellTet> pullFacets(std::span<const HullFacet> facets) {
  std::vector<CellTet> tets;
  for (std::size_t facet = 0; facet < facets.size(); ++facet) pullFacet(facet, facets, tets);
  return tets;
}

std::vector<std::uint8_t> serializeHullTable() {
  const std::vector<std::vector<HullFacet>> facets = allHullFacets();
  std::vector<std::uint32_t> offsets{0};
  std::vector<CellTet> tets;
  for (const std::vector<HullFacet>& entry : facets) {
    const std::vector<CellTet> pulled = pullFacets(entry);
    tets.insert(tets.end(), pulled.begin(), pulled.end());
    offsets.push_back(static_cast<std::uint32_t>(tets.size()));
  }
  const std::size_t offset_bytes = offsets.size() * sizeof(std::uint32_t);
  std::vector<std::uint8_t> bytes(offset_bytes + tets.size() * sizeof(CellTet));
  std::memcpy(bytes.data(), offsets.data(), offset_bytes);
  std::memcpy(bytes.data() + offset_bytes, tets.data(), tets.size() * sizeof(CellTet));
  return bytes;
}

}  // namespace tet4d::hypermesh
