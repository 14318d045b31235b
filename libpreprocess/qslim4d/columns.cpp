#include "libpreprocess/qslim4d/columns.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace tet4d::qslim4d {
namespace {

// The sums of one vertex, or of two.
struct Sums {
  Quadric squares;
  std::array<AttributeTerm, kMostTerms> terms{};
};

// Where d is counted from: the value in mean cells; what is not finite counts as the least.
double referenceOf(const SlimColumn& column, std::uint32_t v, unsigned c) {
  const float value = column.values[std::size_t{v} * column.components + c];
  return column.weight * double{std::isfinite(value) ? value : column.low[c]};
}

template <class Visit>
void forEachTerm(const std::vector<SlimColumn>& list, const Visit& visit) {
  std::size_t term = 0;
  for (const SlimColumn& column : list) {
    if (column.weight == 0) continue;
    for (unsigned c = 0; c < column.components; ++c) visit(column, c, term++);
  }
}

// The sums at v about a place that lies at `offset` from v, relative to the references given.
void addSums(const Columns& columns, std::uint32_t v, const glm::dvec4& offset,
             std::span<const double, kMostTerms> references, Sums& sums) {
  Quadric squares = columns.squares[v].about(offset);
  forEachTerm(columns.list, [&](const SlimColumn& column, unsigned c, std::size_t j) {
    AttributeTerm term = columns.sums[std::size_t{v} * columns.terms + j];
    term.offset += glm::dot(term.gradient, offset);
    const double shift = referenceOf(column, v, c) - references[j];
    squares.b += shift * term.gradient;
    squares.c += shift * (2 * term.offset + term.weight * shift);
    term.offset += term.weight * shift;
    sums.terms[j].gradient += term.gradient;
    sums.terms[j].offset += term.offset;
    sums.terms[j].weight += term.weight;
  });
  sums.squares.add(squares);
}

// With the best values put in: what is left is a quadric in the place alone.
Quadric withBestValues(const Sums& sums, std::size_t terms) {
  Quadric q = sums.squares;
  q.weight = 0;
  for (std::size_t j = 0; j < terms; ++j) {
    const AttributeTerm& term = sums.terms[j];
    if (!(term.weight > 0)) continue;
    q.addPlane(term.gradient, -1 / term.weight, 0);
    q.b -= term.offset / term.weight * term.gradient;
    q.c -= term.offset * term.offset / term.weight;
  }
  q.c = std::max(q.c, 0.0);
  return q;
}

// Of the nearest point of the edge: 0 at u, 1 at v.
double shareOf(const Vec4f& u, const Vec4f& v, const Vec4f& at, const Space& space) {
  const auto lengths = [&](const Vec4f& p) {
    const glm::dvec4 offset = difference(p, u);
    return glm::dvec4(space.axes * spatial(offset), space.speed * offset.w);
  };
  const glm::dvec4 edge = lengths(v);
  const double squared = glm::dot(edge, edge);
  return squared > 0 ? std::clamp(glm::dot(edge, lengths(at)) / squared, 0.0, 1.0) : 0;
}

void makeUnit(std::span<float> v, std::span<const float> otherwise) {
  const double length = std::hypot(double{v[0]}, double{v[1]}, double{v[2]});
  for (std::size_t c = 0; c < 3; ++c) v[c] = length > 0 ? static_cast<float>(v[c] / length) : otherwise[c];
}

}  // namespace

Columns Columns::withoutVertices() const {
  Columns none;
  for (const SlimColumn& column : list) {
    none.list.push_back({column.name, column.components, column.kind, column.weight, column.low, column.high, {}});
  }
  none.terms = terms;
  return none;
}

void Columns::copyTo(Columns& part, std::span<const std::uint32_t> vertices) const {
  for (std::size_t i = 0; i < list.size(); ++i) part.list[i].values.resize(vertices.size() * list[i].components);
  part.squares.resize(inMetric() ? vertices.size() : 0);
  part.sums.resize(vertices.size() * terms);
  if (empty()) return;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) copyVertex(vertices[v], part, v);
}

void Columns::copyVertex(std::uint32_t from, Columns& whole, std::uint32_t to) const {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::size_t n = list[i].components;
    std::copy_n(&list[i].values[from * n], n, &whole.list[i].values[to * n]);
  }
  if (!inMetric()) return;
  whole.squares[to] = squares[from];
  std::copy_n(&sums[from * terms], terms, &whole.sums[to * terms]);
}

Quadric Columns::quadric(std::uint32_t u, std::uint32_t v, const Vec4f& at_u, const Vec4f& at_v) const {
  std::array<double, kMostTerms> references{};
  forEachTerm(list,
              [&](const SlimColumn& column, unsigned c, std::size_t j) { references[j] = referenceOf(column, u, c); });
  Sums both;
  addSums(*this, u, glm::dvec4(0), references, both);
  addSums(*this, v, difference(at_u, at_v), references, both);
  return withBestValues(both, terms);
}

void Columns::merge(std::uint32_t u, std::uint32_t v, const Vec4f& at_u, const Vec4f& at_v, const Vec4f& at,
                    const Space& space) {
  std::array<double, kMostTerms> references{};
  forEachTerm(list,
              [&](const SlimColumn& column, unsigned c, std::size_t j) { references[j] = referenceOf(column, u, c); });
  Sums both;
  if (inMetric()) {
    addSums(*this, u, difference(at, at_u), references, both);
    addSums(*this, v, difference(at, at_v), references, both);
  }
  const double share = shareOf(at_u, at_v, at, space);
  std::array<double, kMostTerms> shifted = references;
  std::size_t term = 0;
  for (SlimColumn& column : list) {
    const std::size_t n = column.components;
    const std::span to_u(column.values.data() + u * n, n), of_v(column.values.data() + v * n, n);
    std::array<float, 4> nearer{};
    std::copy_n(share <= 0.5 ? to_u.begin() : of_v.begin(), n, nearer.begin());
    for (std::size_t c = 0; c < n; ++c) {
      const float a = to_u[c], b = of_v[c];
      const std::size_t j = column.weight == 0 ? 0 : term++;
      if (column.kind == ColumnKind::kLabel || !std::isfinite(a) || !std::isfinite(b)) {
        to_u[c] = nearer[c];
      } else if (column.weight != 0 && both.terms[j].weight > 0) {
        const double best = (references[j] + both.terms[j].offset / both.terms[j].weight) / column.weight;
        to_u[c] = std::clamp(static_cast<float>(best), column.low[c], column.high[c]);
      } else {
        const auto between = static_cast<float>(a + share * (double{b} - a));
        to_u[c] = std::clamp(between, std::min(a, b), std::max(a, b));
      }
    }
    if (column.kind == ColumnKind::kNormal) makeUnit(to_u, nearer);
  }
  if (!inMetric()) return;
  // From now on relative to the values that u has got.
  forEachTerm(list, [&](const SlimColumn& column, unsigned c, std::size_t j) {
    shifted[j] = referenceOf(column, u, c);
    const double shift = references[j] - shifted[j];
    AttributeTerm& sum = both.terms[j];
    both.squares.b += shift * sum.gradient;
    both.squares.c += shift * (2 * sum.offset + sum.weight * shift);
    sum.offset += sum.weight * shift;
    sums[std::size_t{u} * terms + j] = sum;
  });
  both.squares.c = std::max(both.squares.c, 0.0);
  squares[u] = both.squares;
}

void limitAttributes(const Quadric& attributes, double weight, double edge_length, const glm::dvec4& from_u,
                     Placement& placement) {
  const double excess = attributes.value(from_u) - weight * edge_length * edge_length;
  if (!(excess > 0)) return;
  placement.cost = std::max(0.0, placement.cost - excess);
  const double squared = placement.error * placement.error - excess / weight;
  placement.error = weight > 0 && squared > 0 ? std::sqrt(squared) : 0;
}

}  // namespace tet4d::qslim4d
