// The facets of all configurations against CGAL's exact four-dimensional convex hull (about 5 s).
#include <CGAL/Epick_d.h>
#include <CGAL/Triangulation.h>
#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>

#include "libpreprocess/hypermesh/hull_facets.h"

namespace tet4d::hypermesh {
namespace {

using Kernel = CGAL::Epick_d<CGAL::Dimension_tag<4>>;
using Triangulation = CGAL::Triangulation<Kernel>;
using Point = std::array<int, 4>;

std::vector<Point> hullPoints(unsigned configuration) {
  std::vector<Point> points;
  for (std::uint8_t corner = 0; corner < 16; ++corner)
    if (configuration >> corner & 1U) points.push_back(doubledMidpoint({0, corner}));
  for (const CellEdge edge : hullEdges())
    if ((configuration >> edge.base ^ configuration >> (edge.base | edge.direction)) & 1U)
      points.push_back(doubledMidpoint(edge));
  return points;
}

int dot(const Point& a, const Point& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0); }

// Primitive normal of the hyperplane through four points, turned away from all of `points`.
Point outwardNormal(const std::array<Point, 4>& simplex, const std::vector<Point>& points) {
  Point normal{};
  std::array<Point, 4> rows{};
  for (std::size_t k = 1; k < 4; ++k)
    for (std::size_t i = 0; i < 4; ++i) rows[k][i] = simplex[k][i] - simplex[0][i];
  for (std::size_t i = 0; i < 4; ++i) {
    rows[0] = {};
    rows[0][i] = 1;
    normal[i] = determinant4(rows);
  }
  int divisor = 0;
  for (const int c : normal) divisor = std::gcd(divisor, c);
  const bool flip = std::any_of(points.begin(), points.end(),
                                [&](const Point& p) { return dot(normal, p) > dot(normal, simplex[0]); });
  for (int& c : normal) c /= flip ? -divisor : divisor;
  return normal;
}

bool isWall(const Point& normal, int support) {
  const auto nonzero = std::count_if(normal.begin(), normal.end(), [](int c) { return c != 0; });
  return nonzero == 1 && (support == 0 || support == 2);
}

// Facets of CGAL's hull that are not in a wall: normal -> edges whose midpoints lie on it.
std::map<Point, std::uint32_t> exactFacets(unsigned configuration) {
  const std::vector<Point> points = hullPoints(configuration);
  Triangulation triangulation(4);
  for (const Point& p : points) triangulation.insert(Kernel::Point_d(p[0], p[1], p[2], p[3]));
  std::map<Point, std::uint32_t> facets;
  for (auto cell = triangulation.full_cells_begin(); cell != triangulation.full_cells_end(); ++cell) {
    if (!triangulation.is_infinite(cell)) continue;
    std::array<Point, 4> simplex{};
    std::size_t n = 0;
    for (int i = 0; i <= 4; ++i) {
      if (triangulation.is_infinite(cell->vertex(i))) continue;
      for (int axis = 0; axis < 4; ++axis)
        simplex[n][static_cast<std::size_t>(axis)] = static_cast<int>(cell->vertex(i)->point()[axis]);
      ++n;
    }
    const Point normal = outwardNormal(simplex, points);
    const int support = dot(normal, simplex[0]);
    if (isWall(normal, support)) continue;
    std::uint32_t on = 0;
    for (std::uint32_t e = 0; e < 32; ++e) {
      const CellEdge edge = hullEdges()[e];
      const bool cut = (configuration >> edge.base ^ configuration >> (edge.base | edge.direction)) & 1U;
      if (cut && dot(normal, doubledMidpoint(edge)) == support) on |= 1U << e;
    }
    facets[normal] = on;
  }
  return facets;
}

TEST(HullFacets, EqualCgalsExactHull) {
  const auto all = allHullFacets();
  std::size_t compared = 0;
  for (unsigned c = 1; c < kConfigurations; ++c) {
    std::map<Point, std::uint32_t> ours;
    for (const HullFacet& f : all[c]) ours[{f.normal[0], f.normal[1], f.normal[2], f.normal[3]}] = f.edges;
    ASSERT_EQ(ours, exactFacets(c)) << "configuration " << c;
    compared += ours.size();
  }
  EXPECT_EQ(compared, 484'928U);
}

}  // namespace
}  // namespace tet4d::hypermesh
