// The convex hulls behind the table of marching hypercubes, in exact integers: what hull_table_gen runs at build time.
//
// Bhaniramka, Wenger & Crawfis 2000/2004: in a cell the surface is the boundary of the convex hull of the inside
// corners and the midpoints of the cut edges, without what lies in the cell's own walls. Ponchio & Hormann 2008,
// sec. 3.
//
// The 32 edges: number = direction * 8 + rank of the base corner, with direction 0..3 = x, y, z, t and rank = the base
// corner's number with the direction's bit (always 0) taken out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/hypermesh/cell_table.h"

namespace tet4d::hypermesh {

// The 32 edges by number.
std::span<const CellEdge> hullEdges();
std::span<const EdgeDirection> hullDirections();

// A facet of the hull that is not in a wall: all its points are edge midpoints.
struct HullFacet {
  std::uint32_t edges;                 // bit e: the midpoint of edge e is a vertex of the facet
  std::array<std::int16_t, 4> normal;  // primitive, out of the hull: x, y, z, t
  friend bool operator==(const HullFacet&, const HullFacet&) = default;
};

// The facets of one configuration, edges ascending, by trying every primitive normal with coefficients up to 5 (higher
// ones do not occur: checked to 9). About 0.3 ms.
std::vector<HullFacet> hullFacets(unsigned configuration);

// The facets of all 65,536 configurations: 402 of them computed, the others mapped by the 384 symmetries of the cube.
// Signs are not complemented: the hull treats inside and outside differently.
std::vector<std::vector<HullFacet>> allHullFacets();

// Splits the facets of one configuration into tetrahedra by pulling, positive with respect to the facets' normals.
// Always from the configuration's own facets: a triangulation mapped by a symmetry would follow another vertex order.
std::vector<CellTet> pullFacets(std::span<const HullFacet> facets);

// Bytes of the table as hull_table.h reads them: u32 offsets[65537], then the tetrahedra, u8[4] each.
std::vector<std::uint8_t> serializeHullTable();

}  // namespace tet4d::hypermesh
