// Columns of a mesh while it is simplified: values at its vertices, what becomes of them when an edge is collapsed, and
// how much a change of them counts as an error. Private to qslim4d.
//
// Garland & Heckbert 1998 and Hoppe 1999, over space-time: within a tetrahedron a value is linear, with a gradient of
// four numbers and an offset. A vertex keeps the sum over its tetrahedra of w (g . x + d - s)^2 for the value s it may
// have; the best s at each x is put in, which leaves a quadric in x that adds to that of the geometry. Kept apart from
// it: without columns in the metric nothing is stored and nothing computed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/core/vec.h"
#include "libpreprocess/qslim4d/placement.h"
#include "libpreprocess/qslim4d/quadric.h"
#include "libpreprocess/qslim4d/space.h"

namespace tet4d::qslim4d {

// Values that the columns of the metric may have together, components counted.
inline constexpr std::size_t kMostTerms = 16;

enum class ColumnKind {
  kValue,   // linear between vertices
  kLabel,   // whole numbers only: nothing lies between two of them, so the nearer end's is taken
  kNormal,  // as kValue, made unit again
};

struct SlimColumn {
  std::string name;
  unsigned components = 1;
  ColumnKind kind = ColumnKind::kValue;
  double weight = 0;            // mean cells that a change by one counts as; 0: not in the metric
  std::array<float, 4> low{};   // of the finite values, by component
  std::array<float, 4> high{};  // a value is never taken beyond them
  std::vector<float> values;    // components of vertex 0, of vertex 1, …
};

// Sums over a vertex's tetrahedra for one component in the metric: w g, w d and w. Relative to the vertex's place and
// to the value it has, in mean cells.
struct AttributeTerm {
  glm::dvec4 gradient{0};
  double offset = 0, weight = 0;
};

struct Columns {
  std::vector<SlimColumn> list;
  std::size_t terms = 0;            // components in the metric
  std::vector<Quadric> squares;     // by vertex: sum of w (g . x + d)^2 over the terms; its weight is not used
  std::vector<AttributeTerm> sums;  // terms a vertex

  bool empty() const { return list.empty(); }
  bool inMetric() const { return terms > 0; }

  // The same columns of no vertex; those of the vertices given, in their order; and of one vertex, to another's place.
  Columns withoutVertices() const;
  void copyTo(Columns& part, std::span<const std::uint32_t> vertices) const;
  void copyVertex(std::uint32_t from, Columns& whole, std::uint32_t to) const;

  // What a place near u costs the columns if u and v become one vertex there with the best values: about u, weight 0.
  Quadric quadric(std::uint32_t u, std::uint32_t v, const Vec4f& at_u, const Vec4f& at_v) const;

  // Gives u the values that it has when u and v have become one vertex at `at`, and adds the sums of v to its own. In
  // the metric: the best value by the sums, within the column's range. Otherwise linear along the edge, by the point of
  // it that is nearest to `at`: between both ends' values whatever the place. A value that is not finite at an end
  // neither spreads nor is made up: the nearer end's is taken, as for labels. Writes u's only.
  void merge(std::uint32_t u, std::uint32_t v, const Vec4f& at_u, const Vec4f& at_v, const Vec4f& at,
             const Space& space);
};

// Where gradients are steep, a place off the edge overstates what is lost: what the columns cost there counts as no
// more than if the surface were off by the edge's length. attributes: of Columns::quadric(), about u; weight: of the
// geometry's quadric.
void limitAttributes(const Quadric& attributes, double weight, double edge_length, const glm::dvec4& from_u,
                     Placement& placement);

}  // namespace tet4d::qslim4d
