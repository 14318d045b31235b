// Columns of a simplified mesh: the attribute quadric against its definition, what values become, what they cost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <random>
#include <set>

#include "libpreprocess/qslim4d/attributes.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/qslim4d/closed_slices.h"

namespace tet4d::qslim4d {
namespace {

using hypermesh::Tet;
namespace marching = hypermesh::testing;

SlimColumn columnOf(std::string name, unsigned components, std::vector<float> values, double weight = 0,
                    ColumnKind kind = ColumnKind::kValue) {
  SlimColumn column;
  column.name = std::move(name);
  column.components = components;
  column.kind = kind;
  column.weight = weight;
  column.low.fill(INFINITY), column.high.fill(-INFINITY);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    column.low[i % components] = std::min(column.low[i % components], values[i]);
    column.high[i % components] = std::max(column.high[i % components], values[i]);
  }
  column.values = std::move(values);
  return column;
}

// A flat sheet that moves along x: exactly flat in 4D.
marching::ExtractedMesh sheet() {
  marching::MemoryFrames<float> frames({14, 13, 13}, 6, [](auto x, auto, auto, auto k) {
    return static_cast<float>(4.25 + 0.5 * static_cast<double>(k) - static_cast<double>(x));
  });
  hypermesh::Options options;
  options.iso = 0;
  return marching::extract(frames, options);
}

marching::ExtractedMesh ball() {
  marching::MemoryFrames<float> frames({16, 15, 15}, 6, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    return static_cast<float>(4.3 + 0.2 * f(k) - std::hypot(f(x) - 6.5 - 0.3 * f(k), f(y) - 7, f(z) - 7.2));
  });
  hypermesh::Options options;
  options.iso = 0;
  return marching::extract(frames, options);
}

template <class Field>
std::vector<float> valuesOf(const std::vector<Vec4f>& vertices, const Field& field) {
  std::vector<float> values;
  for (const Vec4f& v : vertices) values.push_back(static_cast<float>(field(v)));
  return values;
}

SlimMesh slimOf(const marching::ExtractedMesh& mesh, std::vector<SlimColumn> columns = {}) {
  SlimMesh slim =
      makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, Metric::kSlice);
  slim.columns.list = std::move(columns);
  addAttributeQuadrics(slim, Metric::kSlice);
  return slim;
}

Stats run(SlimMesh& mesh, std::uint64_t target, Order order = Order::kPasses, std::size_t threads = 1) {
  Options options;
  options.order = order;
  options.target_tets = target;
  outofcore::ThreadExecutor executor(threads);
  outofcore::Progress progress;
  return simplify(mesh, options, executor, progress);
}

template <class Visit>
void forEachLive(const SlimMesh& mesh, const Visit& visit) {
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.isUsed(v)) visit(v);
}

// The definition: over the tetrahedra at both ends, w (g . x + d - s)^2 with g from a 4x4 system whose last row says
// that g has no part along the normal, at the s that makes it least.
double costByDefinition(const SlimMesh& mesh, std::uint32_t u, std::uint32_t v, const Vec4f& at) {
  const SlimColumn& column = mesh.columns.list[0];
  const double speed = mesh.space.speed;
  const auto lengths = [&](const Vec4f& p, const Vec4f& o) {
    glm::dvec4 d = difference(p, o);
    return glm::dvec4(mesh.space.axes * spatial(d), speed * d.w);
  };
  std::vector<std::pair<double, double>> terms;  // w, value at `at`
  for (const std::uint32_t end : {u, v}) {
    mesh.forEachTet(end, [&](std::uint32_t t, std::uint32_t) {
      const Tet& tet = mesh.tets[t];
      const Vec4f& o = mesh.positions[tet[0]];
      glm::dmat4 rows;
      glm::dvec4 right(0);
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t w = tet[static_cast<std::size_t>(i) + 1];
        rows[i] = lengths(mesh.positions[w], o);
        right[i] = column.weight * (double{column.values[w]} - column.values[tet[0]]);
      }
      rows[3] = glm::normalize(cross4(rows[0], rows[1], rows[2]));
      const glm::dvec4 g = glm::inverse(glm::transpose(rows)) * right;
      const glm::dvec4 raw = cross4(difference(mesh.positions[tet[1]], o), difference(mesh.positions[tet[2]], o),
                                    difference(mesh.positions[tet[3]], o));
      const double w = std::max(glm::length(mesh.space.spatialNormal(raw)), 0.05 * std::abs(raw.w) / speed);
      terms.emplace_back(w, column.weight * column.values[tet[0]] + glm::dot(g, lengths(at, o)));
    });
  }
  double weights = 0, mean = 0, cost = 0;
  for (const auto& [w, value] : terms) weights += w, mean += w * value;
  mean /= weights;
  for (const auto& [w, value] : terms) cost += w * (value - mean) * (value - mean);
  return cost;
}

TEST(Columns, AttributeQuadricIsItsDefinition) {
  const marching::ExtractedMesh mesh = ball();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(1000, 1003);  // far from 0: differences are what counts
  std::vector<float> values;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) values.push_back(number(random));
  const SlimMesh slim = slimOf(mesh, {columnOf("c", 1, values, 2.5)});
  for (int i = 0; i < 60; ++i) {
    const Tet& tet = slim.tets[random() % slim.tets.size()];
    const Vec4f &at_u = slim.positions[tet[0]], &at_v = slim.positions[tet[1]];
    const Quadric q = slim.columns.quadric(tet[0], tet[1], at_u, at_v);
    const Vec4f at{at_u.x + 0.25F, at_v.y, at_u.z - 0.125F, at_v.t};
    const double expected = costByDefinition(slim, tet[0], tet[1], at);
    EXPECT_NEAR(q.value(difference(at, at_u)), expected, 1e-6 * (1 + expected));
  }
}

TEST(Columns, ALinearColumnOnAFlatSheetCostsNothingAndStaysExact) {
  const auto field = [](const Vec4f& p) { return 2 * p.y - p.z + 3 * p.t; };
  const marching::ExtractedMesh mesh = sheet();
  SlimMesh slim = slimOf(mesh, {columnOf("f", 1, valuesOf(mesh.vertices, field), 1)});
  const Stats stats = run(slim, mesh.tets.size() / 20);
  EXPECT_LT(slim.live_tets, mesh.tets.size() / 10);
  EXPECT_LT(stats.largest_error, 1e-3);
  forEachLive(
      slim, [&](std::uint32_t v) { EXPECT_NEAR(slim.columns.list[0].values[v], field(slim.positions[v]), 2e-3) << v; });
}

// Geometry that says nothing, and a front in the column: in the metric it stays where it is.
TEST(Columns, InTheMetricKeepsWhatTheGeometryDoesNotSee) {
  const auto field = [](const Vec4f& p) { return std::tanh(2 * (p.y - 4.5 - 0.6 * p.t)); };
  const marching::ExtractedMesh mesh = sheet();
  double errors[2] = {0, 0};
  for (const bool in_metric : {false, true}) {
    SlimMesh slim = slimOf(mesh, {columnOf("front", 1, valuesOf(mesh.vertices, field), in_metric ? 5 : 0)});
    run(slim, mesh.tets.size() / 8);
    // Over the tetrahedra's middles: what the linear function is off there, by volume.
    double sum = 0, volume = 0;
    for (const Tet& tet : testing::liveTets(slim)) {
      Vec4f middle{0, 0, 0, 0};
      double value = 0;
      for (const std::uint32_t v : tet) {
        const Vec4f& p = slim.positions[v];
        middle = {middle.x + p.x / 4, middle.y + p.y / 4, middle.z + p.z / 4, middle.t + p.t / 4};
        value += slim.columns.list[0].values[v] / 4.0;
      }
      const Vec4f& o = slim.positions[tet[0]];
      const double size =
          glm::length(cross4(difference(slim.positions[tet[1]], o), difference(slim.positions[tet[2]], o),
                             difference(slim.positions[tet[3]], o)));
      sum += size * (value - field(middle)) * (value - field(middle)), volume += size;
    }
    errors[in_metric ? 1 : 0] = std::sqrt(sum / volume);
  }
  EXPECT_LT(errors[1], 0.5 * errors[0]) << errors[0] << " without, " << errors[1] << " in the metric";
}

TEST(Columns, CarriedAlongTheyChangeNoCollapse) {
  const marching::ExtractedMesh mesh = ball();
  SlimMesh without = slimOf(mesh);
  SlimMesh with = slimOf(mesh, {columnOf("f", 1, valuesOf(mesh.vertices, [](const Vec4f& p) { return p.x; }))});
  EXPECT_TRUE(without.columns.empty());
  EXPECT_TRUE(with.columns.squares.empty() && with.columns.sums.empty()) << "no quadrics where none are asked for";
  run(without, 3000), run(with, 3000);
  EXPECT_EQ(without.positions, with.positions);
  forEachLive(with, [&](std::uint32_t v) { EXPECT_NEAR(with.columns.list[0].values[v], with.positions[v].x, 1.0); });
}

TEST(Columns, AnyThreadsGiveTheSameValues) {
  const marching::ExtractedMesh mesh = ball();
  const auto field = [](const Vec4f& p) { return std::sin(p.x) * p.y + p.t; };
  SlimMesh one = slimOf(mesh, {columnOf("f", 1, valuesOf(mesh.vertices, field), 1)}), three = one;
  run(one, 4000, Order::kPasses, 1), run(three, 4000, Order::kPasses, 3);
  EXPECT_EQ(one.positions, three.positions);
  EXPECT_EQ(one.columns.list[0].values, three.columns.list[0].values);
}

class ColumnOrders : public ::testing::TestWithParam<Order> {};
INSTANTIATE_TEST_SUITE_P(All, ColumnOrders, ::testing::Values(Order::kPasses, Order::kMultichoice, Order::kHeap));

// White noise of every kind: ranges, labels, normals; in the metric and out of it.
TEST_P(ColumnOrders, RangesLabelsAndNormalsHoldUnderNoise) {
  const marching::ExtractedMesh mesh = ball();
  std::mt19937 random(9);
  std::normal_distribution<float> normal;
  const std::size_t n = mesh.vertices.size();
  std::vector<float> noise, more, labels, normals, holes;
  for (std::size_t i = 0; i < n; ++i) {
    noise.push_back(normal(random)), more.push_back(1e6F * normal(random));
    labels.push_back(static_cast<float>(random() % 3 * 7));
    holes.push_back(i % 5 == 0 ? NAN : i % 7 == 0 ? INFINITY : normal(random));
    const float v[3] = {normal(random), normal(random), normal(random)};
    const float length = std::hypot(v[0], v[1], v[2]);
    for (const float x : v) normals.push_back(x / length);
  }
  SlimMesh slim =
      slimOf(mesh, {columnOf("noise", 1, noise), columnOf("more", 1, more, 1e-6),
                    columnOf("labels", 1, labels, 0, ColumnKind::kLabel),
                    columnOf("normal", 3, normals, 0, ColumnKind::kNormal), columnOf("holes", 1, holes, 0.5)});
  run(slim, mesh.tets.size() / 6, GetParam());
  const auto& list = slim.columns.list;
  std::uint64_t live = 0, unknown = 0;
  forEachLive(slim, [&](std::uint32_t v) {
    for (const std::size_t c : {std::size_t{0}, std::size_t{1}}) {
      EXPECT_GE(list[c].values[v], list[c].low[0]);
      EXPECT_LE(list[c].values[v], list[c].high[0]);
    }
    const float label = list[2].values[v];
    EXPECT_TRUE(label == 0 || label == 7 || label == 14) << label;
    const float* unit = &list[3].values[std::size_t{3} * v];
    EXPECT_NEAR(std::hypot(unit[0], unit[1], unit[2]), 1, 1e-5);
    ++live, unknown += std::isfinite(list[4].values[v]) ? 0 : 1;
    if (std::isfinite(list[4].values[v])) {
      EXPECT_GE(list[4].values[v], list[4].low[0]);
      EXPECT_LE(list[4].values[v], list[4].high[0]);
    }
  });
  EXPECT_GT(unknown, live / 20) << "what is unknown stays so";
  EXPECT_LT(unknown, live / 2) << "and does not spread";
}

TEST(ColumnsStiff, TimeRescaledGivesTheSameCollapses) {
  const marching::ExtractedMesh mesh = ball();
  const auto values = valuesOf(mesh.vertices, [](const Vec4f& p) { return std::sin(p.y + p.t); });
  marching::ExtractedMesh scaled = mesh;
  for (Vec4f& v : scaled.vertices) v.t *= 0x1p-30F;
  scaled.header.domain.max.t *= 0x1p-30F;
  SlimMesh a = slimOf(mesh, {columnOf("f", 1, values, 1)}), b = slimOf(scaled, {columnOf("f", 1, values, 1)});
  Options options;
  options.order = Order::kHeap;
  options.target_tets = 5000;
  options.rules.frames = false;
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  simplify(a, options, executor, progress), simplify(b, options, executor, progress);
  EXPECT_EQ(testing::liveTets(a), testing::liveTets(b));
}

TEST(ColumnsStiff, JumpsAndFlatTetrahedraCostNoMoreThanTheEdge) {
  // A jump of 1e9 over a tetrahedron 1e-6 thin: the gradient is 1e15.
  SlimMesh mesh = makeSlimMesh({{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 1}, {0, 0, 1e-6F, 0}, {0.5F, 0, -1, 0}},
                               {{0, 1, 2, 3}, {0, 2, 1, 4}}, {{-9, -9, -9, -9}, {9, 9, 9, 9}}, {}, Metric::kSlice);
  mesh.columns.list.push_back(columnOf("jump", 1, {0, 1e9F, -1e9F, 1e9F, 0}, 1));
  addAttributeQuadrics(mesh, Metric::kSlice);
  const Collapser collapser(mesh, {});
  Placement placement;
  ASSERT_TRUE(collapser.evaluate(0, 1, placement));
  EXPECT_TRUE(std::isfinite(placement.cost) && std::isfinite(placement.error));
  EXPECT_LT(placement.error, 4 * mesh.space.extent(difference(mesh.positions[1], mesh.positions[0])));
}

}  // namespace
}  // namespace tet4d::qslim4d
