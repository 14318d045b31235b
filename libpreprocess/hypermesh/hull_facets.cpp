#include "libpreprocess/hypermesh/hull_facets.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <numeric>

namespace tet4d::hypermesh {
namespace {

using Point = std::array<int, 4>;
constexpr int kMaxCoefficient = 5;

struct EdgeNumbering {
  std::vector<CellEdge> edges;
  std::vector<EdgeDirection> directions;
  EdgeNumbering() { directions = numberEdges(std::array<std::uint8_t, 4>{1, 2, 4, 8}, edges); }
};

const EdgeNumbering& numbering() {
  static const EdgeNumbering instance;
  return instance;
}

int dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

Point doubledCorner(unsigned corner) {
  return {static_cast<int>(corner & 1) * 2, static_cast<int>(corner >> 1 & 1) * 2,
          static_cast<int>(corner >> 2 & 1) * 2, static_cast<int>(corner >> 3 & 1) * 2};
}

std::uint32_t cutEdges(unsigned configuration) {
  std::uint32_t cut = 0;
  for (std::uint32_t e = 0; e < 32; ++e) {
    const CellEdge edge = numbering().edges[e];
    if ((configuration >> edge.base ^ configuration >> (edge.base | edge.direction)) & 1u) cut |= 1u << e;
  }
  return cut;
}

std::vector<Point> primitiveNormals() {
  std::vector<Point> normals;
  constexpr int k = kMaxCoefficient;
  for (int x = -k; x <= k; ++x)
    for (int y = -k; y <= k; ++y)
      for (int z = -k; z <= k; ++z)
        for (int t = -k; t <= k; ++t)
          if (std::gcd(std::gcd(x, y), std::gcd(z, t)) == 1) normals.push_back({x, y, z, t});
  return normals;
}

// Whether the midpoints span three dimensions. Integer elimination; entries stay far below overflow for four rows.
bool spansThreeDimensions(std::uint32_t edges) {
  const Point origin = doubledMidpoint(numbering().edges[static_cast<std::size_t>(std::countr_zero(edges))]);
  std::vector<Point> basis;
  for (std::uint32_t rest = edges & (edges - 1); rest; rest &= rest - 1) {
    Point v = doubledMidpoint(numbering().edges[static_cast<std::size_t>(std::countr_zero(rest))]);
    for (std::size_t i = 0; i < 4; ++i) v[i] -= origin[i];
    for (const Point& b : basis) {
      const auto pivot =
          static_cast<std::size_t>(std::find_if(b.begin(), b.end(), [](int c) { return c; }) - b.begin());
      const int scale_v = b[pivot], scale_b = v[pivot];
      for (std::size_t i = 0; i < 4; ++i) v[i] = v[i] * scale_v - b[i] * scale_b;
    }
    if (v != Point{}) basis.push_back(v);
  }
  return basis.size() == 3;
}

// A signed permutation of the axes, acting on corners and edges by number.
struct Symmetry {
  std::array<std::uint8_t, 4> axis_to;  // old axis -> new axis
  unsigned flips;                       // new axes that are reversed
  std::array<std::uint8_t, 16> corner;
  std::array<std::uint8_t, 32> edge;

  Symmetry(const std::array<std::uint8_t, 4>& permutation, unsigned flipped) : axis_to(permutation), flips(flipped) {
    for (unsigned c = 0; c < 16; ++c) corner[c] = static_cast<std::uint8_t>(permute(c) ^ flips);
    for (std::size_t e = 0; e < 32; ++e) {
      const CellEdge from = numbering().edges[e];
      const unsigned axes = permute(from.direction);
      const unsigned base = corner[from.base] & ~axes;
      edge[e] = numbering().directions[static_cast<std::size_t>(std::countr_zero(axes))].number[base];
    }
  }
  unsigned permute(unsigned bits) const {
    unsigned out = 0;
    for (unsigned axis = 0; axis < 4; ++axis) out |= (bits >> axis & 1u) << axis_to[axis];
    return out;
  }
  unsigned mapConfiguration(unsigned configuration) const {
    unsigned out = 0;
    for (unsigned c = 0; c < 16; ++c) out |= (configuration >> c & 1u) << corner[c];
    return out;
  }
  HullFacet mapFacet(const HullFacet& facet) const {
    HullFacet out{};
    for (std::uint32_t rest = facet.edges; rest; rest &= rest - 1)
      out.edges |= 1u << edge[static_cast<std::size_t>(std::countr_zero(rest))];
    for (std::size_t axis = 0; axis < 4; ++axis) {
      const std::size_t to = axis_to[axis];
      out.normal[to] = static_cast<std::int16_t>(flips >> to & 1u ? -facet.normal[axis] : facet.normal[axis]);
    }
    return out;
  }
};

std::vector<Symmetry> cubeSymmetries() {
  std::vector<Symmetry> all;
  std::array<std::uint8_t, 4> permutation{0, 1, 2, 3};
  do {
    for (unsigned flips = 0; flips < 16; ++flips) all.emplace_back(permutation, flips);
  } while (std::next_permutation(permutation.begin(), permutation.end()));
  return all;
}

void sortByEdges(std::vector<HullFacet>& facets) {
  std::sort(facets.begin(), facets.end(), [](const HullFacet& a, const HullFacet& b) { return a.edges < b.edges; });
}

}  // namespace

std::span<const CellEdge> hullEdges() { return numbering().edges; }
std::span<const EdgeDirection> hullDirections() { return numbering().directions; }

std::vector<HullFacet> hullFacets(unsigned configuration) {
  static const std::vector<Point> normals = primitiveNormals();
  const std::uint32_t cut = cutEdges(configuration);
  std::vector<Point> corners;
  for (unsigned c = 0; c < 16; ++c)
    if (configuration >> c & 1u) corners.push_back(doubledCorner(c));
  std::vector<std::pair<std::uint32_t, Point>> midpoints;
  for (std::uint32_t rest = cut; rest; rest &= rest - 1) {
    const int e = std::countr_zero(rest);
    midpoints.emplace_back(1u << e, doubledMidpoint(numbering().edges[static_cast<std::size_t>(e)]));
  }

  std::vector<HullFacet> facets;
  if (midpoints.size() < 4) return facets;
  for (const Point& normal : normals) {
    int support = -1000;
    std::uint32_t on = 0;
    for (const auto& [bit, point] : midpoints) {
      const int value = dot(normal, point);
      if (value > support) support = value, on = 0;
      if (value == support) on |= bit;
    }
    // An inside corner has a whole cube corner of the hull around it, so only walls touch one: >= drops the walls too.
    if (std::popcount(on) < 4) continue;
    if (std::any_of(corners.begin(), corners.end(), [&](const Point& p) { return dot(normal, p) >= support; }))
      continue;
    if (!spansThreeDimensions(on)) continue;
    facets.push_back({on,
                      {static_cast<std::int16_t>(normal[0]), static_cast<std::int16_t>(normal[1]),
                       static_cast<std::int16_t>(normal[2]), static_cast<std::int16_t>(normal[3])}});
  }
  sortByEdges(facets);
  return facets;
}

std::vector<std::vector<HullFacet>> allHullFacets() {
  const std::vector<Symmetry> symmetries = cubeSymmetries();
  std::vector<std::vector<HullFacet>> all(kConfigurations);
  std::vector<bool> known(kConfigurations, false);
  for (unsigned representative = 0; representative < kConfigurations; ++representative) {
    if (known[representative]) continue;
    const std::vector<HullFacet> facets = hullFacets(representative);
    for (const Symmetry& symmetry : symmetries) {
      const unsigned image = symmetry.mapConfiguration(representative);
      if (known[image]) continue;
      known[image] = true;
      for (const HullFacet& facet : facets) all[image].push_back(symmetry.mapFacet(facet));
      sortByEdges(all[image]);
    }
  }
  return all;
}

}  // namespace tet4d::hypermesh
