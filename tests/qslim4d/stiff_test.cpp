// Stiff and extreme scenes through all orders: manifolds whose slices are closed at any time, walls exact, no flips.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <tuple>

#include "libpreprocess/error.h"
#include "libpreprocess/qslim4d/mesh_file.h"
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

marching::ExtractedMesh extractField(std::array<std::uint64_t, 3> dims, std::size_t count, const Field& field,
                                     const AffineMap& map = {}) {
  marching::MemoryFrames<float> frames(dims, count, [&](auto x, auto y, auto z, auto k) {
    return static_cast<float>(
        field(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z), static_cast<double>(k)));
  });
  frames.map(map);
  hypermesh::Options options;
  options.iso = 0;
  return marching::extract(frames, options);
}

SlimMesh slimOf(const marching::ExtractedMesh& mesh) {
  return makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, Metric::kSlice);
}

// Blocks so small that most of a mesh's vertices are shared by some.
constexpr std::size_t kSmallBlock = 256;

Stats run(SlimMesh& mesh, Order order, std::uint64_t target, std::size_t block_vertices = Options().block_vertices) {
  Options options;
  options.block_vertices = block_vertices;
  options.order = order;
  options.target_tets = target;
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  return simplify(mesh, options, executor, progress);
}

double ballAt(double x, double y, double z, double cx, double cy, double cz, double r) {
  return r - std::hypot(x - cx, y - cy, z - cz);
}

struct Scene {
  const char* name;
  std::array<std::uint64_t, 3> dims;
  std::size_t frames;
  Field field;
  double ratio;  // that must be reached
  // Share of the slices' area that may be turned over, at a fifth of the tetrahedra and at the end.
  double turned_at_a_fifth = 0, turned = 0.05;
};

// What moves not at all, slowly, fast; is born, dies, merges; touches the walls; slides in itself.
const std::vector<Scene>& scenes() {
  static const std::vector<Scene> all{
      {"still",
       {13, 13, 13},
       8,
       [](double x, double y, double z, double) { return ballAt(x, y, z, 6, 6.1, 6.2, 4.3); },
       0.02,
       1e-4,
       0.05},
      {"slow",
       {13, 13, 13},
       6,
       [](double x, double y, double z, double t) { return ballAt(x, y, z, 5.5 + 0.02 * t, 6, 6, 4.1); },
       0.04,
       1e-3,
       0.05},
      {"half",
       {15, 13, 13},
       6,
       [](double x, double y, double z, double t) { return ballAt(x, y, z, 5.5 + 0.5 * t, 6, 6, 4.1); },
       0.06,
       3e-3,
       0.05},
      {"fast",
       {40, 12, 12},
       6,
       [](double x, double y, double z, double t) { return ballAt(x, y, z, 6.2 + 5 * t, 5.5, 5.6, 4.1); },
       0.25,
       0.01,
       0.05},
      {"events",
       {20, 13, 13},
       8,
       [](double x, double y, double z, double t) {
         const double apart = 6.2 - 0.8 * t;  // merge
         return std::max({ballAt(x, y, z, 9.5 - apart, 6, 6, 2.9), ballAt(x, y, z, 9.5 + apart, 6, 6, 2.9),
                          (t == 3 || t == 4 ? 1.6 : -9.0) - std::hypot(x - 9.6, y - 2.2, z - 2.3)});  // born and gone
       },
       0.15,
       0.02,
       0.05},
      {"walls",
       {13, 13, 13},
       6,
       [](double x, double y, double z, double t) { return ballAt(x, y, z, 0.4 * t, 6.1, 11.8, 5.3); },
       0.06,
       5e-3,
       0.05},
      {"plane", {11, 11, 11}, 6, [](double, double, double z, double) { return 5.3 - z; }, 0.01, 0, 0},
      {"tilted",
       {11, 11, 11},
       6,
       [](double x, double y, double z, double t) { return 5.3 + 0.2 * x - 0.1 * y + 0.3 * t - z; },
       0.03,
       0,
       0},
  };
  return all;
}

// Share of the area of slices, which must be closed, that is turned over: against the gradient of the field at the
// triangle's middle. Triangles of a coarse mesh may lean.
double turnedShare(const SlimMesh& slim, const Scene& scene, const Bounds4f& box, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> time(box.min.t, box.max.t);
  double area = 0, turned = 0;
  for (int i = 0; i < 12; ++i) {
    const float t = i == 0 ? box.min.t : i == 1 ? box.max.t : time(random);
    const SliceMesh slice = testing::sliceOf(slim, box, t);
    EXPECT_FALSE(slice.triangles.empty() && std::string(scene.name) != "events") << t;
    EXPECT_EQ(testing::openEdges(slice, box), 0u) << t;
    for (const auto& [a, b, c] : slice.triangles) {
      const Vec3f &p = slice.positions[a], &q = slice.positions[b], &r = slice.positions[c];
      const glm::dvec3 u(q.x - p.x, q.y - p.y, q.z - p.z), w(r.x - p.x, r.y - p.y, r.z - p.z);
      const glm::dvec3 normal = glm::cross(u, w),
                       middle = glm::dvec3(p.x + q.x + r.x, p.y + q.y + r.y, p.z + q.z + r.z) / 3.0;
      const auto at = [&](int axis, double d) {
        glm::dvec3 m = middle;
        m[axis] += d;
        return scene.field(m.x, m.y, m.z, t);
      };
      const glm::dvec3 gradient(at(0, 0.1) - at(0, -0.1), at(1, 0.1) - at(1, -0.1), at(2, 0.1) - at(2, -0.1));
      area += glm::length(normal);
      if (glm::dot(normal, gradient) > 0.2 * glm::length(normal) * glm::length(gradient)) turned += glm::length(normal);
    }
  }
  return area > 0 ? turned / area : 0;
}

struct Way {
  Order order;
  std::size_t block_vertices;
};
constexpr std::array<Way, 4> kWays{{{Order::kPasses, Options().block_vertices},
                                    {Order::kPasses, kSmallBlock},
                                    {Order::kMultichoice, Options().block_vertices},
                                    {Order::kHeap, Options().block_vertices}}};

class StiffScenes : public ::testing::TestWithParam<std::tuple<Way, std::size_t>> {};
INSTANTIATE_TEST_SUITE_P(All, StiffScenes,
                         ::testing::Combine(::testing::ValuesIn(kWays), ::testing::Range<std::size_t>(0, 8)));

TEST_P(StiffScenes, StayManifoldsWithClosedSlicesAndExactWalls) {
  const auto& [way, rank] = GetParam();
  const Scene& scene = scenes()[rank];
  SCOPED_TRACE(scene.name);
  const marching::ExtractedMesh mesh = extractField(scene.dims, scene.frames, scene.field);
  SlimMesh slim = slimOf(mesh);
  const std::vector<Walls> walls = slim.walls;
  run(slim, way.order, mesh.tets.size() / 5, way.block_vertices);
  const double at_a_fifth = turnedShare(slim, scene, mesh.header.domain, 7);
  run(slim, way.order, mesh.tets.size() / 100, way.block_vertices);
  EXPECT_LE(slim.live_tets, static_cast<std::uint64_t>(scene.ratio * static_cast<double>(mesh.tets.size())));
  const std::vector<Tet> left = testing::liveTets(slim);
  EXPECT_EQ(left.size(), slim.live_tets);
  const topology::LinkCheck links = topology::checkLinks(left, slim.positions.size(), true);
  EXPECT_TRUE(links.ok()) << (links.faults.empty() ? "" : links.faults[0]);

  const Bounds4f& box = mesh.header.domain;
  const float low[4] = {box.min.x, box.min.y, box.min.z, box.min.t},
              high[4] = {box.max.x, box.max.y, box.max.z, box.max.t};
  Bounds4f before, after;
  for (const Vec4f& p : mesh.vertices) before.add(p);
  for (std::uint32_t v = 0; v < slim.positions.size(); ++v) {
    if (!slim.isUsed(v)) continue;
    after.add(slim.positions[v]);
    const float p[4] = {slim.positions[v].x, slim.positions[v].y, slim.positions[v].z, slim.positions[v].t};
    for (unsigned c = 0; c < 4; ++c) {
      EXPECT_EQ((slim.walls[v] >> (2 * c) & 1U) != 0, p[c] == low[c]) << "a wall is kept to the bit";
      EXPECT_EQ((slim.walls[v] >> (2 * c + 1) & 1U) != 0, p[c] == high[c]);
      EXPECT_TRUE(p[c] >= low[c] && p[c] <= high[c]);
    }
  }
  EXPECT_EQ(after.min.t, before.min.t) << "the surface begins and ends when it did";
  EXPECT_EQ(after.max.t, before.max.t);

  const double turned = turnedShare(slim, scene, box, static_cast<unsigned>(rank) + 1);
  EXPECT_LE(at_a_fifth, scene.turned_at_a_fifth) << "outward is where the field falls";
  EXPECT_LE(turned, scene.turned) << "as far as so few triangles can tell";
}

// ---- extremes

marching::ExtractedMesh noise(double share) {
  std::mt19937 random(21);
  std::vector<float> samples;
  for (int i = 0; i < 9 * 9 * 9 * 6; ++i)
    samples.push_back(static_cast<double>(random() % 10'000) < 10'000 * share ? 0.4F : -0.6F);
  return extractField({9, 9, 9}, 6, [&](double x, double y, double z, double t) {
    return samples[static_cast<std::size_t>(((t * 9 + z) * 9 + y) * 9 + x)];
  });
}

TEST(QslimStiff, SpecksStayAndNothingIsTorn) {
  for (const double share : {0.01, 0.15}) {
    const marching::ExtractedMesh mesh = noise(share);
    for (const auto& [order, block_vertices] : kWays) {
      SlimMesh slim = slimOf(mesh);
      const Stats stats = run(slim, order, 1, block_vertices);
      EXPECT_TRUE(stats.stalled) << "a speck is left of every speck";
      EXPECT_LT(slim.live_tets, mesh.tets.size());
      EXPECT_TRUE(topology::checkLinks(testing::liveTets(slim), slim.positions.size(), true).ok());
      for (const float t : {0.0F, 1.3F, 2.5F, 4.9F})
        EXPECT_EQ(testing::openEdges(testing::sliceOf(slim, mesh.header.domain, t), mesh.header.domain), 0u);
    }
  }
}

// One layer of cubes: no vertex is inside.
TEST(QslimStiff, EveryVertexOnTheBoundary) {
  constexpr std::uint32_t kSide = 12;
  const auto number = [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (z * (kSide + 1) + y) * (kSide + 1) + x;
  };
  std::vector<Vec4f> points;
  for (std::uint32_t z = 0; z <= 1; ++z)
    for (std::uint32_t y = 0; y <= kSide; ++y)
      for (std::uint32_t x = 0; x <= kSide; ++x) {
        const auto f = [](std::uint32_t i) { return static_cast<float>(i); };
        points.push_back({f(x), f(y), f(z), 0.7F * f(x) + 0.2F * f(y) + 0.1F * f(z) + 0.02F * f(x) * f(x)});
      }
  static constexpr std::uint32_t kPaths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<Tet> tets;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x)
      for (const auto& path : kPaths) {
        std::uint32_t at[3] = {x, y, 0};
        Tet tet{number(x, y, 0), 0, 0, 0};
        for (std::size_t k = 0; k < 3; ++k) ++at[path[k]], tet[k + 1] = number(at[0], at[1], at[2]);
        tets.push_back(tet);
      }
  for (const bool on_walls : {false, true}) {
    const float m = on_walls ? 0 : 1, last = kSide;
    for (const Order order : {Order::kPasses, Order::kMultichoice, Order::kHeap}) {
      SlimMesh slim =
          makeSlimMesh(points, tets, {{-m, -m, -m, -9}, {last + m, last + m, 1 + m, 99}}, {}, Metric::kSlice);
      run(slim, order, tets.size() / 5);
      EXPECT_LT(slim.live_tets, tets.size() / 2);
      EXPECT_TRUE(topology::checkLinks(testing::liveTets(slim), slim.positions.size(), true).ok());
      Bounds4f bounds;
      for (std::uint32_t v = 0; v < slim.positions.size(); ++v)
        if (slim.isUsed(v)) bounds.add(slim.positions[v]);
      const float slack = on_walls ? 0 : 0.5F;
      EXPECT_NEAR(bounds.min.x, 0, slack);
      EXPECT_NEAR(bounds.max.x, last, slack);
      EXPECT_NEAR(bounds.max.y, last, slack);
      EXPECT_NEAR(bounds.max.z, 1, slack);
    }
  }
}

// Cells of 1 : 1 : 1e6 (needles), 1e7 from the origin: the quadrics see lengths, not cells.
TEST(QslimStiff, NeedlesFarFromTheOrigin) {
  const AffineMap map{{1e7, -1e7, 1e7}, {{{1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e3}}}};
  const marching::ExtractedMesh mesh = extractField(
      {13, 13, 13}, 6, [](double x, double y, double z, double t) { return ballAt(x, y, z, 5.5 + 0.2 * t, 6, 6, 4.1); },
      map);
  for (const Order order : {Order::kPasses, Order::kMultichoice, Order::kHeap}) {
    SlimMesh slim = slimOf(mesh);
    run(slim, order, mesh.tets.size() / 10);
    EXPECT_LT(slim.live_tets, mesh.tets.size() / 4);
    EXPECT_TRUE(topology::checkLinks(testing::liveTets(slim), slim.positions.size(), true).ok());
    for (const float t : {0.5F, 2.2F, 4.4F})
      EXPECT_EQ(testing::openEdges(testing::sliceOf(slim, mesh.header.domain, t), mesh.header.domain), 0u);
  }
}

TEST(QslimStiff, AVertexThatIsNoNumberIsRefusedByPage) {
  const std::string path = marching::temporaryPath("nan_vertex.t4h");
  hypermesh::MeshHeader header{};
  header.index_to_world = {};
  header.domain = {{0, 0, 0, 0}, {9, 9, 9, 1}};
  header.isovalue = NAN;
  auto writer = hypermesh::Writer::create(path, header, std::vector<double>{0, 1}, {}, paged::Codec::kRaw, true);
  ASSERT_TRUE(writer.ok());
  const std::vector<Vec4f> points{{0, 0, 0, 0}, {1, NAN, 0, 0}, {0, 1, 0, 1}, {0, 0, 1, 0}};
  const std::vector<Tet> tets{{0, 1, 2, 3}};
  ASSERT_TRUE(writer.value().addPage(points, {}, tets, {{0, 0, 0, 0}, {1, 1, 1, 1}}).ok());
  ASSERT_TRUE(writer.value().close("{}").ok());
  auto file = hypermesh::File::open(path);
  if (!file.ok()) {
    EXPECT_EQ(file.fault().code, FaultCode::kBadInput);
    return;
  }
  outofcore::Progress progress;
  try {
    readMesh(file.value(), {}, progress);
    FAIL() << "not a number";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kBadInput);
    EXPECT_NE(error.fault().place.find("page 0"), std::string::npos) << error.fault().place;
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
