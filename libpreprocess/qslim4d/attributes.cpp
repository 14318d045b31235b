#include "libpreprocess/qslim4d/attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <string>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::qslim4d {
namespace {

// A direction in which a tetrahedron is thinner than this share of its longest edge has no gradient: f32 coordinates
// say no more of it.
constexpr double kLeastExtent = 1e-6;

// The edges of a tetrahedron from its first vertex as an orthonormal basis, the longest remainder first, so that
// needles lose no digits: edge[order[k]] = sum over i <= k of along[k][i] * basis[i].
struct EdgeBasis {
  std::array<glm::dvec4, 3> basis{};
  std::array<std::array<double, 3>, 3> along{};
  std::array<std::size_t, 3> order{0, 1, 2};
  std::size_t rank = 0;

  explicit EdgeBasis(std::array<glm::dvec4, 3> edges) {
    const double longest = std::max({glm::length(edges[0]), glm::length(edges[1]), glm::length(edges[2])});
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t best = k;
      for (std::size_t i = k + 1; i < 3; ++i)
        if (glm::length(edges[order[i]]) > glm::length(edges[order[best]])) best = i;
      std::swap(order[k], order[best]);
      std::swap(along[k], along[best]);
      const double length = glm::length(edges[order[k]]);
      if (!(length > kLeastExtent * longest)) return;
      basis[k] = edges[order[k]] / length;
      along[k][k] = length;
      ++rank;
      for (std::size_t i = k + 1; i < 3; ++i) {
        along[i][k] = glm::dot(edges[order[i]], basis[k]);
        edges[order[i]] -= along[i][k] * basis[k];
      }
    }
  }

  // The vector of the edges' span whose products with the edges are `differences`.
  glm::dvec4 gradient(const std::array<double, 3>& differences) const {
    glm::dvec4 sum(0);
    std::array<double, 3> parts{};
    for (std::size_t k = 0; k < rank; ++k) {
      double rest = differences[order[k]];
      for (std::size_t i = 0; i < k; ++i) rest -= along[k][i] * parts[i];
      parts[k] = rest / along[k][k];
      sum += parts[k] * basis[k];
    }
    return sum;
  }
};

// As in the quadrics of the geometry.
double weightOf(const SlimMesh& mesh, const hypermesh::Tet& tet, Metric metric) {
  const Vec4f& o = mesh.positions[tet[0]];
  const glm::dvec4 n = cross4(difference(mesh.positions[tet[1]], o), difference(mesh.positions[tet[2]], o),
                              difference(mesh.positions[tet[3]], o));
  const double slope = glm::length(mesh.space.spatialNormal(n));
  return metric == Metric::kPaper ? slope * slope : std::max(slope, kLeastSlope * std::abs(n.w) / mesh.space.speed);
}

void addTet(SlimMesh& mesh, const hypermesh::Tet& tet, double weight) {
  const Space& space = mesh.space;
  const auto toLengths = [&](std::uint32_t v) {
    const glm::dvec4 offset = difference(mesh.positions[v], mesh.positions[tet[0]]);
    return glm::dvec4(space.axes * spatial(offset), space.speed * offset.w);
  };
  const EdgeBasis basis({toLengths(tet[1]), toLengths(tet[2]), toLengths(tet[3])});
  Columns& columns = mesh.columns;
  std::size_t term = 0;
  for (const SlimColumn& column : columns.list) {
    if (column.weight == 0) continue;
    for (unsigned c = 0; c < column.components; ++c, ++term) {
      std::array<double, 4> values{};
      for (std::size_t i = 0; i < 4; ++i)
        values[i] = column.weight * double{column.values[std::size_t{tet[i]} * column.components + c]};
      const std::array<double, 3> differences{values[1] - values[0], values[2] - values[0], values[3] - values[0]};
      const glm::dvec4 in_lengths = basis.gradient(differences);
      const glm::dvec4 gradient(glm::transpose(space.axes) * spatial(in_lengths), space.speed * in_lengths.w);
      if (!std::isfinite(glm::dot(gradient, gradient))) continue;
      for (const std::uint32_t v : tet) {
        // Relative to the vertex's own value, d is 0.
        columns.squares[v].addPlane(gradient, weight, 0);
        AttributeTerm& sum = columns.sums[std::size_t{v} * columns.terms + term];
        sum.gradient += weight * gradient;
        sum.weight += weight;
      }
    }
  }
}

}  // namespace

void addAttributeQuadrics(SlimMesh& mesh, Metric metric) {
  Columns& columns = mesh.columns;
  columns.terms = 0;
  for (const SlimColumn& column : columns.list) columns.terms += column.weight == 0 ? 0 : column.components;
  if (columns.terms > kMostTerms) {
    throw Error(FaultCode::kUsage, "", "--attributes",
                "the columns named have " + std::to_string(columns.terms) + " components, at most " +
                    std::to_string(kMostTerms) + " can be in the metric",
                "name fewer");
  }
  if (!columns.inMetric()) return;
  columns.squares.assign(mesh.positions.size(), {});
  columns.sums.assign(mesh.positions.size() * columns.terms, {});
  for (const hypermesh::Tet& tet : mesh.tets) {
    const double weight = weightOf(mesh, tet, metric);
    if (weight > 0) addTet(mesh, tet, weight);
  }
}

}  // namespace tet4d::qslim4d
