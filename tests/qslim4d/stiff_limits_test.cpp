// The rules of validity, collapse by collapse, and units and places at the ends of what float32 holds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include "libpreprocess/measure/slice_measures.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/qslim4d/closed_slices.h"

namespace tet4d::qslim4d {
namespace {

using hypermesh::Tet;
namespace marching = hypermesh::testing;
using Field = std::function<double(double x, double y, double z, double t)>;

marching::ExtractedMesh extractField(std::array<std::uint64_t, 3> dims, std::size_t count, const Field& field) {
  marching::MemoryFrames<float> frames(dims, count, [&](auto x, auto y, auto z, auto k) {
    return static_cast<float>(
        field(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z), static_cast<double>(k)));
  });
  hypermesh::Options options;
  options.iso = 0;
  return marching::extract(frames, options);
}

double movingBall(double x, double y, double z, double t) { return 4.1 - std::hypot(x - 5.5 - 0.2 * t, y - 6, z - 6); }

Stats run(SlimMesh& mesh, Order order, std::uint64_t target) {
  Options options;
  options.order = order;
  options.target_tets = target;
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  return simplify(mesh, options, executor, progress);
}

constexpr Order kOrders[] = {Order::kPasses, Order::kMultichoice, Order::kHeap};

// The spatial part of the 4D normal of three edges, by cofactors, and the temporal part.
std::array<double, 4> normalOf(const std::array<Vec4f, 4>& p) {
  double e[3][4];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec4f &a = p[i + 1], &o = p[0];
    const double edge[4] = {double{a.x} - o.x, double{a.y} - o.y, double{a.z} - o.z, double{a.t} - o.t};
    std::copy_n(edge, 4, e[i]);
  }
  std::array<double, 4> normal{};
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t k[3], n = 0;
    for (std::size_t i = 0; i < 4; ++i)
      if (i != c) k[n++] = i;
    const double det = e[0][k[0]] * (e[1][k[1]] * e[2][k[2]] - e[1][k[2]] * e[2][k[1]]) -
                       e[0][k[1]] * (e[1][k[0]] * e[2][k[2]] - e[1][k[2]] * e[2][k[0]]) +
                       e[0][k[2]] * (e[1][k[0]] * e[2][k[1]] - e[1][k[1]] * e[2][k[0]]);
    normal[c] = c % 2 == 0 ? det : -det;
  }
  return normal;
}

// Random edges until nothing is left to do: no collapse that is allowed turns a spatial normal by more than the 75
// degrees promised, makes a tetrahedron of four equal times, or one without volume.
TEST(QslimStiff, NoAllowedCollapseTurnsANormalOrFlattensATetrahedron) {
  const Field fields[] = {
      movingBall, [](double x, double y, double z, double) { return 4.3 - std::hypot(x - 6, y - 6.1, z - 6.2); },
      [](double x, double y, double z, double t) { return 4.1 - std::hypot(x - 1.2 - 2.2 * t, y - 6, z - 6); },
      [](double x, double y, double z, double t) {
        const auto ball = [&](double at) { return 2.9 - std::hypot(x - at, y - 6, z - 6); };
        return std::max(ball(9.5 - 6.2 + 0.8 * t), ball(9.5 + 6.2 - 0.8 * t));
      }};
  for (const Field& field : fields) {
    const marching::ExtractedMesh mesh = extractField({18, 13, 13}, 6, field);
    SlimMesh slim =
        makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, Metric::kSlice);
    Collapser collapser(slim, {});
    std::mt19937 random(3);
    std::size_t made = 0;
    double most_turned = 0;
    for (std::size_t n = 0; n < 12 * mesh.tets.size(); ++n) {
      const Tet& drawn = slim.tets[random() % slim.tets.size()];
      if (drawn[0] == kNone) continue;
      const std::size_t i = random() % 4, j = (i + 1 + random() % 3) % 4;
      const std::uint32_t u = std::min(drawn[i], drawn[j]), v = std::max(drawn[i], drawn[j]);
      Placement placement;
      if (!collapser.evaluate(u, v, placement)) continue;
      if (collapser.judge(u, v, placement.at) != Verdict::kAllowed) continue;
      for (const auto& [end, other] : {std::pair{u, v}, std::pair{v, u}}) {
        slim.forEachTet(end, [&, moved = end, gone = other](std::uint32_t t, std::uint32_t) {
          std::array<Vec4f, 4> before{}, after{};
          bool dies = false;
          for (std::size_t c = 0; c < 4; ++c) {
            const std::uint32_t w = slim.tets[t][c];
            before[c] = slim.positions[w];
            after[c] = w == moved ? placement.at : before[c];
            dies |= w == gone;
          }
          if (dies) return;
          EXPECT_FALSE(after[0].t == after[1].t && after[0].t == after[2].t && after[0].t == after[3].t);
          const auto a = normalOf(before), b = normalOf(after);
          const double speed = slim.space.speed, la = std::hypot(a[0], a[1], a[2]), lb = std::hypot(b[0], b[1], b[2]);
          EXPECT_GT(lb + std::abs(b[3]), 0);
          // A sheet that jumps has no spatial normal: there the whole one counts.
          if (speed * la <= 1e-3 * std::abs(a[3]) * 1.001) return;
          const double cosine = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / (la * lb);
          most_turned = std::max(most_turned, std::acos(std::clamp(cosine, -1.0, 1.0)));
        });
      }
      slim.live_tets -= collapser.collapse(u, v, placement.at);
      --slim.live_vertices;
      ++made;
    }
    EXPECT_GT(made, mesh.vertices.size() / 3);
    EXPECT_LE(most_turned, 75.001 / 180 * std::acos(-1.0));
    EXPECT_GT(most_turned, 1.0) << "the rule has refused something near it";
  }
}

// Time in units of 1e-9 and 1e9, which are no powers of two: the same error, closed, manifold.
TEST(QslimStiff, TimesOfANanosecondAndOfThirtyYears) {
  const marching::ExtractedMesh mesh = extractField({13, 13, 13}, 6, movingBall);
  for (const Order order : kOrders) {
    double usual = 0;
    for (const double unit : {1.0, 1e-9, 1e9}) {
      std::vector<Vec4f> points = mesh.vertices;
      for (Vec4f& p : points) p.t = static_cast<float>(p.t * unit);
      Bounds4f domain = mesh.header.domain;
      domain.min.t = static_cast<float>(domain.min.t * unit), domain.max.t = static_cast<float>(domain.max.t * unit);
      SlimMesh slim = makeSlimMesh(points, mesh.tets, domain, {}, Metric::kSlice);
      const Stats stats = run(slim, order, mesh.tets.size() / 10);
      EXPECT_LE(slim.live_tets, mesh.tets.size() / 10) << unit;
      EXPECT_TRUE(topology::checkLinks(testing::liveTets(slim), slim.positions.size(), true).ok());
      for (const double t : {0.3, 2.0, 4.71})
        EXPECT_EQ(testing::openEdges(testing::sliceOf(slim, domain, static_cast<float>(t * unit)), domain), 0u) << unit;
      if (unit == 1) usual = stats.largest_error;
      EXPECT_LT(stats.largest_error, 2 * usual + 1e-6) << unit;
      EXPECT_GT(stats.largest_error, 0.4 * usual) << unit;
    }
  }
}

marching::ExtractedMesh scaledBy(marching::ExtractedMesh mesh, double scale) {
  const auto scaled = [scale](const Vec4f& p) -> Vec4f {
    return {static_cast<float>(p.x * scale), static_cast<float>(p.y * scale), static_cast<float>(p.z * scale), p.t};
  };
  for (Vec4f& p : mesh.vertices) p = scaled(p);
  mesh.header.domain.min = scaled(mesh.header.domain.min), mesh.header.domain.max = scaled(mesh.header.domain.max);
  return mesh;
}

// Lengths of atoms and of galaxies: costs that no float32 holds. The same error for the scale, in every order.
TEST(QslimStiff, SizesOfAtomsAndGalaxies) {
  const marching::ExtractedMesh mesh = extractField({13, 13, 13}, 5, movingBall);
  for (const Order order : kOrders) {
    double usual = 0;
    for (const double scale : {1.0, 1e-12, 1e21}) {
      const marching::ExtractedMesh other = scaledBy(mesh, scale);
      SlimMesh slim = makeSlimMesh(other.vertices, other.tets, other.header.domain, {}, Metric::kSlice);
      const Stats stats = run(slim, order, mesh.tets.size() / 10);
      EXPECT_LE(slim.live_tets, mesh.tets.size() / 10) << scale;
      if (scale == 1) usual = stats.largest_error;
      EXPECT_NEAR(stats.largest_error / scale, usual, 0.5 * usual) << scale;
    }
  }
}

// Coordinates that float32 holds as denormals, with few digits left, and such whose squares overflow it.
TEST(QslimStiff, DenormalAndHugeCoordinates) {
  const marching::ExtractedMesh mesh = extractField({13, 13, 13}, 5, movingBall);
  for (const double scale : {1e-41, 1e30}) {
    const marching::ExtractedMesh other = scaledBy(mesh, scale);
    const Bounds4f& domain = other.header.domain;
    for (const Order order : kOrders) {
      SlimMesh slim = makeSlimMesh(other.vertices, other.tets, domain, {}, Metric::kSlice);
      run(slim, order, mesh.tets.size() / 4);
      EXPECT_LE(slim.live_tets, mesh.tets.size() / 2) << scale;
      EXPECT_TRUE(topology::checkLinks(testing::liveTets(slim), slim.positions.size(), true).ok());
      for (std::uint32_t v = 0; v < slim.positions.size(); ++v) {
        if (!slim.isUsed(v)) continue;
        EXPECT_TRUE(std::isfinite(slim.positions[v].x + slim.positions[v].t));
      }
      for (const float t : {0.5F, 2.2F})
        EXPECT_EQ(testing::openEdges(testing::sliceOf(slim, domain, t), domain), 0u) << scale;
    }
  }
}

// Where the cheapest edges are all refused, chance alone would not get on.
TEST(QslimStiff, MultichoiceGoesOnWhereTheCheapestEdgesMayNotBeCollapsed) {
  const marching::ExtractedMesh mesh = extractField({30, 30, 30}, 10, [](double x, double y, double z, double t) {
    double sum = -1;
    for (int i = 0; i < 5; ++i) {
      const double p = 1.3 * i + 0.6 * t, at[3] = {15 + 6 * std::sin(p), 15 + 5 * std::cos(2 * p), 13.4 + 1.1 * i};
      sum += 14 / (0.1 + (x - at[0]) * (x - at[0]) + (y - at[1]) * (y - at[1]) + (z - at[2]) * (z - at[2]));
    }
    return sum;
  });
  SlimMesh slim =
      makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, Metric::kSlice);
  const Stats stats = run(slim, Order::kMultichoice, mesh.tets.size() / 100);
  EXPECT_FALSE(stats.stalled) << slim.live_tets << " of " << mesh.tets.size();
  EXPECT_TRUE(topology::checkLinks(testing::liveTets(slim), slim.positions.size(), true).ok());
}

// Exactly at the time of vertices sheets without thickness may lie upon each other; no edge is open for that.
TEST(QslimStiff, SlicesExactlyAtFramesBoundAVolumeInBothMetrics) {
  const marching::ExtractedMesh mesh = extractField({27, 27, 27}, 8, [](double x, double y, double z, double t) {
    return std::max(6.4 - std::hypot(x - 9 - 0.7 * t, y - 13, z - 13),
                    4.2 - std::hypot(x - 19, y - 12 + 0.3 * t, z - 14));
  });
  for (const Metric metric : {Metric::kSlice, Metric::kPaper}) {
    for (const Order order : kOrders) {
      SlimMesh slim = makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, metric);
      run(slim, order, mesh.tets.size() / 50);
      for (int k = 0; k <= 7; ++k) {
        const SliceMesh slice = testing::sliceOf(slim, mesh.header.domain, static_cast<float>(k));
        const measure::SliceMeasures measures = measure::measureSlice(slice.positions, slice.triangles);
        EXPECT_TRUE(measures.bounds()) << "frame " << k << ": " << measures.unbalanced_edges << " of " << measures.edges
                                       << ", " << measures.edges_over_two << " over two";
        EXPECT_GT(measures.volume, 0);
      }
    }
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
