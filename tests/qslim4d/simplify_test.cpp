// Whole meshes through the three orders: what is left is a manifold, near the input, the same for any threads.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "libpreprocess/exchange/foreign_runs.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/measure/sphere.h"

namespace tet4d::qslim4d {
namespace {

using hypermesh::Tet;
namespace marching = hypermesh::testing;

constexpr testing::MovingBall kBall{{7.2, 7.5, 7}, {0.4, -0.1, 0.2}, 3.9, 0.3};

// A ball that moves and grows and ends at the walls of time; with `wall` it is cut by the wall x = 0.
marching::ExtractedMesh ball(const std::string& path, bool wall = false) {
  marching::MemoryFrames<float> frames({18, 16, 17}, 7, [&](auto x, auto y, auto z, auto k) {
    const double dx = wall ? 6 : 0;
    return static_cast<float>(kBall.fieldAt(static_cast<double>(x) + dx, static_cast<double>(y), static_cast<double>(z),
                                            static_cast<double>(k)));
  });
  hypermesh::Options options;
  options.iso = 0;
  return marching::extractTo(path, frames, options);
}

SlimMesh slimOf(const marching::ExtractedMesh& mesh, Metric metric = Metric::kSlice) {
  return makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, metric);
}

std::vector<Tet> liveTets(const SlimMesh& mesh) {
  std::vector<Tet> tets;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    if (mesh.isLive(t)) tets.push_back(mesh.tets[t]);
  return tets;
}

Stats run(SlimMesh& mesh, const Options& options, std::size_t threads = 1) {
  outofcore::ThreadExecutor executor(threads);
  outofcore::Progress progress;
  return simplify(mesh, options, executor, progress);
}

Options toTets(Order order, std::uint64_t target) {
  Options options;
  options.order = order;
  options.target_tets = target;
  return options;
}

class Orders : public ::testing::TestWithParam<std::tuple<Order, Metric>> {};
INSTANTIATE_TEST_SUITE_P(All, Orders,
                         ::testing::Combine(::testing::Values(Order::kPasses, Order::kMultichoice, Order::kHeap),
                                            ::testing::Values(Metric::kSlice, Metric::kPaper)));

TEST_P(Orders, ATenthIsLeftAManifoldNearTheInput) {
  const auto [order, metric] = GetParam();
  const std::string path = marching::temporaryPath("qslim_in.t4h"), out = marching::temporaryPath("qslim_out.t4h");
  const marching::ExtractedMesh mesh = ball(path);
  SlimMesh slim = slimOf(mesh, metric);
  const Stats stats = run(slim, toTets(order, mesh.tets.size() / 10));
  EXPECT_FALSE(stats.stalled);
  EXPECT_LE(slim.live_tets, mesh.tets.size() / 10);
  EXPECT_GT(slim.live_tets, mesh.tets.size() / 10 - 100) << "no more than asked for";
  EXPECT_GT(stats.aligned, stats.collapses / 4);

  hypermesh::MeshHeader header = mesh.header;
  auto writer = hypermesh::Writer::create(out, header, mesh.times, {}, paged::Codec::kRaw, true);
  ASSERT_TRUE(writer.ok());
  outofcore::Progress progress;
  writeMesh(slim, stats.largest_error, writer.value(), progress);
  ASSERT_TRUE(writer.value().close("{}").ok());
  const hypermesh::File result = std::move(hypermesh::File::open(out)).value();
  const hypermesh::File reference = std::move(hypermesh::File::open(path)).value();
  EXPECT_TRUE(result.verify().ok()) << result.verify().fault().what;
  EXPECT_EQ(result.header().tets, slim.live_tets);
  const topology::HypermeshCheck faces = topology::checkHypermesh(result, progress);
  EXPECT_TRUE(faces.ok()) << (faces.faults.empty() ? "" : faces.faults[0]);
  EXPECT_EQ(faces.unused_vertices, 0u);
  outofcore::MemoryBudget memory;
  const topology::LinkCheck links = topology::checkLinks(result, memory, progress);
  EXPECT_TRUE(links.ok()) << (links.faults.empty() ? "" : links.faults[0]);

  outofcore::ThreadExecutor executor(1);
  const measure::SliceDistance distance =
      measure::compareSlices(result, reference, {0, 1, 2.37, 4, 5.63, 6}, {1e-3, 5000, 100'000}, executor, progress);
  EXPECT_LT(distance.rms, 0.12);
  EXPECT_LT(distance.max, 1.0);
  EXPECT_LT(distance.volume_error, 0.03);
  EXPECT_GT(distance.max, 1e-4) << "something must have moved";
}

TEST(Simplify, ThePassesOfAnyThreadsGiveTheSameMesh) {
  const marching::ExtractedMesh mesh = ball(marching::temporaryPath("qslim_threads.t4h"));
  SlimMesh one = slimOf(mesh), three = slimOf(mesh);
  run(one, toTets(Order::kPasses, 3000), 1);
  run(three, toTets(Order::kPasses, 3000), 3);
  EXPECT_EQ(one.positions, three.positions);
  EXPECT_EQ(liveTets(one), liveTets(three));
}

TEST(Simplify, SeedsChangeMultichoiceAndNothingElseDoes) {
  const marching::ExtractedMesh mesh = ball(marching::temporaryPath("qslim_seed.t4h"));
  SlimMesh a = slimOf(mesh), b = slimOf(mesh), c = slimOf(mesh);
  Options options = toTets(Order::kMultichoice, 5000);
  run(a, options), run(b, options);
  options.seed = 1;
  run(c, options);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_NE(a.positions, c.positions);
}

// Time rescaled by a power of two, which f32 takes without rounding: the same edges go, in the same order.
TEST(Simplify, CollapsesDoNotDependOnTheUnitOfTime) {
  const marching::ExtractedMesh mesh = ball(marching::temporaryPath("qslim_time.t4h"));
  for (const Metric metric : {Metric::kSlice, Metric::kPaper}) {
    for (const float scale : {0x1p-30F, 0x1p30F}) {
      marching::ExtractedMesh scaled = mesh;
      for (Vec4f& v : scaled.vertices) v.t *= scale;
      scaled.header.domain.min.t *= scale, scaled.header.domain.max.t *= scale;
      SlimMesh a = slimOf(mesh, metric), b = slimOf(scaled, metric);
      Options options = toTets(Order::kHeap, 6000);
      options.rules.frames = false;  // a frame's time is one frame long whatever the unit
      run(a, options), run(b, options);
      EXPECT_EQ(liveTets(a), liveTets(b)) << scale;
      std::uint64_t different = 0;
      for (std::size_t v = 0; v < a.positions.size(); ++v)
        different += std::abs(a.positions[v].x - b.positions[v].x) > 1e-4F ? 1 : 0;
      EXPECT_EQ(different, 0u) << scale;
    }
  }
}

TEST(Simplify, WallsAndBothEndsOfTimeStayWhereTheyAre) {
  const marching::ExtractedMesh mesh = ball(marching::temporaryPath("qslim_walls.t4h"), true);
  SlimMesh slim = slimOf(mesh);
  const auto count = [&](const SlimMesh& m, Walls wall) {
    std::uint64_t n = 0;
    for (std::uint32_t v = 0; v < m.positions.size(); ++v) n += m.isUsed(v) && (m.walls[v] & wall) != 0 ? 1 : 0;
    return n;
  };
  const std::uint64_t on_x = count(slim, 1), at_start = count(slim, 1u << 6);
  ASSERT_GT(on_x, 100u);
  run(slim, toTets(Order::kPasses, mesh.tets.size() / 10));
  for (std::uint32_t v = 0; v < slim.positions.size(); ++v) {
    if (!slim.isUsed(v)) continue;
    const Vec4f& p = slim.positions[v];
    EXPECT_EQ((slim.walls[v] & 1) != 0, p.x == 0) << v;
    EXPECT_TRUE((slim.walls[v] & 1u << 6) == 0 || p.t == 0);
    EXPECT_TRUE((slim.walls[v] & 1u << 7) == 0 || p.t == 6);
    EXPECT_TRUE(p.x >= 0 && p.t >= 0 && p.t <= 6);
  }
  EXPECT_LT(count(slim, 1), on_x / 2) << "walls are simplified within";
  EXPECT_LT(count(slim, 1u << 6), at_start / 2);
  // Every face of the boundary lies on a wall still.
  std::vector<std::uint8_t> may_bound(slim.positions.size());
  for (std::size_t v = 0; v < may_bound.size(); ++v) may_bound[v] = slim.walls[v] != 0 ? 1 : 0;
  EXPECT_TRUE(topology::checkLinks(liveTets(slim), may_bound).ok());
}

TEST(Simplify, ErrorIsALimitAndMoreOfItTakesMore) {
  const marching::ExtractedMesh mesh = ball(marching::temporaryPath("qslim_error.t4h"));
  std::uint64_t left = mesh.tets.size();
  for (const double error : {0.01, 0.05, 0.2}) {
    SlimMesh slim = slimOf(mesh);
    Options options;
    options.most_error = error;
    const Stats stats = run(slim, options);
    EXPECT_LE(stats.largest_error, error);
    EXPECT_LT(slim.live_tets, left);
    left = slim.live_tets;
  }
}

// ---- stiff and extreme

TEST(SimplifyStiff, AStaticSceneCollapsesInTimeToAlmostNothing) {
  marching::MemoryFrames<float> frames({14, 14, 14}, 20, [](auto x, auto y, auto z, auto) {
    const auto d = [](auto i) { return static_cast<double>(i) - 6.5; };
    return static_cast<float>(4.3 - std::hypot(d(x), d(y), d(z)));
  });
  hypermesh::Options extraction;
  extraction.iso = 0;
  const marching::ExtractedMesh mesh = marching::extract(frames, extraction);
  SlimMesh slim = slimOf(mesh);
  Options options;
  options.most_error = 1e-4;
  const Stats stats = run(slim, options);
  EXPECT_LT(slim.live_tets, mesh.tets.size() / 8) << "nineteen steps are one";
  EXPECT_LE(stats.largest_error, 1e-4);
  EXPECT_TRUE(topology::checkLinks(liveTets(slim), slim.positions.size(), true).ok());
}

TEST(SimplifyStiff, FastSlowAnisotropicAndFarMeshesStayManifolds) {
  for (const double speed : {0.02, 3.0}) {
    marching::MemoryFrames<float> frames({26, 12, 12}, 6, [&](auto x, auto y, auto z, auto k) {
      const testing::MovingBall moving{{6, 5.5, 5.5}, {speed, 0, 0}, 3.2, 0};
      return static_cast<float>(moving.fieldAt(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z),
                                               static_cast<double>(k)));
    });
    hypermesh::Options extraction;
    extraction.iso = 0;
    for (const double far : {0.0, 1e7}) {
      AffineMap map{{far, -far, far}, {{{1e-3, 0, 0}, {0, 1, 0}, {0, 0, 1e3}}}};
      frames.map(map);
      const marching::ExtractedMesh mesh = marching::extract(frames, extraction);
      SlimMesh slim = slimOf(mesh);
      run(slim, toTets(Order::kPasses, mesh.tets.size() / 8));
      EXPECT_LT(slim.live_tets, mesh.tets.size() / 3) << speed << " " << far;
      EXPECT_TRUE(topology::checkLinks(liveTets(slim), slim.positions.size(), true).ok()) << speed << " " << far;
      for (const Vec4f& p : slim.positions)
        EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.t));
    }
  }
}

TEST(SimplifyStiff, NothingAndOneTetrahedron) {
  for (const bool one : {false, true}) {
    SlimMesh mesh = makeSlimMesh(
        one ? std::vector<Vec4f>{{0, 0, 0, 0}, {1, 0, 0, 0.5F}, {0, 1, 0, 1}, {0, 0, 1, 0}} : std::vector<Vec4f>{},
        one ? std::vector<Tet>{{0, 1, 2, 3}} : std::vector<Tet>{}, {{-9, -9, -9, 0}, {9, 9, 9, 1}}, {}, Metric::kSlice);
    for (const Order order : {Order::kPasses, Order::kMultichoice, Order::kHeap}) {
      const Stats stats = run(mesh, toTets(order, 0));
      EXPECT_EQ(stats.collapses, 0u);
      EXPECT_EQ(mesh.live_tets, one ? 1u : 0u);
      EXPECT_EQ(stats.stalled, one);
    }
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
