// Blocks that large meshes are swept in: they do not touch, and what is left of them is a manifold near the input, the
// same for any threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "libpreprocess/qslim4d/block_work.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "libpreprocess/qslim4d/vertex_blocks.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/measure/sphere.h"
#include "tests/qslim4d/closed_slices.h"

namespace tet4d::qslim4d {
namespace {

using hypermesh::Tet;
namespace marching = hypermesh::testing;

constexpr tet4d::testing::MovingBall kBall{{8.2, 8.5, 8}, {0.4, -0.1, 0.2}, 4.9, 0.3};

// A ball that moves and grows, ends at the walls of time and is cut by the wall x = 0.
marching::ExtractedMesh ball() {
  marching::MemoryFrames<float> frames({16, 18, 19}, 9, [](auto x, auto y, auto z, auto k) {
    return static_cast<float>(kBall.fieldAt(static_cast<double>(x) + 5, static_cast<double>(y), static_cast<double>(z),
                                            static_cast<double>(k)));
  });
  hypermesh::Options options;
  options.iso = 0;
  return marching::extract(frames, options);
}

SlimMesh slimOf(const marching::ExtractedMesh& mesh) {
  return makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, mesh.header.index_to_world, Metric::kSlice);
}

Stats run(SlimMesh& mesh, std::uint64_t target, std::size_t block_vertices, std::size_t threads,
          double error = INFINITY) {
  Options options;
  options.target_tets = target;
  options.most_error = error;
  options.block_vertices = block_vertices;
  outofcore::ThreadExecutor executor(threads);
  outofcore::Progress progress;
  return simplify(mesh, options, executor, progress);
}

std::vector<std::size_t> blockOfVertices(const SlimMesh& mesh, const VertexBlocks& blocks) {
  std::vector<std::size_t> block_of(mesh.positions.size(), blocks.count());
  for (std::size_t b = 0; b < blocks.count(); ++b)
    for (const std::uint32_t v : blocks.verticesOf(b)) block_of[v] = b;
  return block_of;
}

TEST(VertexBlocks, HoldEveryVertexOnceAndKnowWhatTheyShare) {
  const SlimMesh mesh = slimOf(ball());
  outofcore::ThreadExecutor executor(2);
  std::vector<std::uint8_t> always_shared(mesh.positions.size(), 1);
  for (std::size_t sweep = 0; sweep < 3; ++sweep) {
    const VertexBlocks blocks = cutBlocks(mesh, 256, sweep, executor);
    ASSERT_GT(blocks.count(), mesh.positions.size() / 256);
    const std::vector<std::size_t> block_of = blockOfVertices(mesh, blocks);
    EXPECT_EQ(blocks.order.size(), mesh.positions.size());
    for (std::size_t b = 0; b < blocks.count(); ++b) {
      EXPECT_LE(blocks.verticesOf(b).size(), 256U + 256U);
      EXPECT_TRUE(std::is_sorted(blocks.verticesOf(b).begin(), blocks.verticesOf(b).end()));
    }
    std::vector<std::uint8_t> shared(mesh.positions.size());
    for (const Tet& tet : mesh.tets)
      for (const std::uint32_t v : tet)
        for (const std::uint32_t w : tet)
          if (block_of[v] != block_of[w]) shared[v] = 1;
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
      ASSERT_LT(block_of[v], blocks.count());
      EXPECT_EQ(blocks.is_shared[blocks.places[v]], shared[v]) << v;
      if (shared[v] == 0) always_shared[v] = 0;
    }
    std::vector<std::size_t> listed(mesh.tets.size(), blocks.count());
    for (std::size_t b = 0; b < blocks.count(); ++b)
      for (const std::uint32_t t : blocks.tetsOf(b)) listed[t] = b;
    for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
      const Tet& tet = mesh.tets[t];
      const auto* inside = std::find_if(tet.begin(), tet.end(), [&](std::uint32_t v) { return shared[v] == 0; });
      EXPECT_EQ(listed[t], inside == tet.end() ? blocks.count() : block_of[*inside]);
    }
  }
  const auto left = std::accumulate(always_shared.begin(), always_shared.end(), std::size_t{0});
  EXPECT_LT(left, mesh.positions.size() / 2) << "sweeps cut at different places";
}

// Quadrics of a mesh some of whose edges have been collapsed; ends inside, on walls and near them.
TEST(EdgePrices, OfTwoEdgesAtATimeAreThoseOfOne) {
  SlimMesh mesh = slimOf(ball());
  run(mesh, mesh.live_tets / 2, 1u << 20, 1);
  for (const bool frames : {true, false}) {
    CollapseRules rules;
    rules.frames = frames;
    Collapser collapser(mesh, rules);
    std::uint64_t priced_edges = 0;
    for (std::uint32_t u = 0; u < mesh.positions.size(); ++u) {
      if (!mesh.isUsed(u)) continue;
      std::vector<std::uint32_t> larger;
      for (const std::uint32_t w : collapser.neighbours(u))
        if (w > u) larger.push_back(w);
      std::vector<Collapser::Priced> priced;
      collapser.price(u, larger, priced);
      std::size_t allowed = 0;
      for (const std::uint32_t w : larger) {
        Placement placement;
        if (!collapser.evaluate(u, w, placement)) continue;
        ++allowed;
        const auto found = std::find_if(priced.begin(), priced.end(), [&](const auto& one) { return one.other == w; });
        ASSERT_NE(found, priced.end());
        EXPECT_EQ(found->cost, placement.cost);
        EXPECT_EQ(found->error, placement.error);
      }
      EXPECT_EQ(priced.size(), allowed);
      priced_edges += allowed;
    }
    EXPECT_GT(priced_edges, 1000U);
  }
}

TEST(BlockSweeps, LeaveAManifoldTheSameForAnyThreads) {
  const marching::ExtractedMesh input = ball();
  for (const std::size_t block : {128U, 512U}) {
    SlimMesh one = slimOf(input), three = slimOf(input);
    const std::uint64_t target = input.tets.size() / 10;
    const Stats stats = run(one, target, block, 1);
    run(three, target, block, 3);
    EXPECT_EQ(one.positions, three.positions);
    EXPECT_EQ(testing::liveTets(one), testing::liveTets(three));
    EXPECT_FALSE(stats.stalled);
    EXPECT_LE(one.live_tets, target);
    EXPECT_GT(one.live_tets, target - 100) << "no more than asked for";
    EXPECT_EQ(testing::liveTets(one).size(), one.live_tets);
    std::vector<std::uint8_t> may_bound(one.positions.size());
    for (std::size_t v = 0; v < may_bound.size(); ++v) may_bound[v] = one.walls[v] != 0 ? 1 : 0;
    const topology::LinkCheck links = topology::checkLinks(testing::liveTets(one), may_bound);
    EXPECT_TRUE(links.ok()) << (links.faults.empty() ? "" : links.faults[0]);
  }
}

// The heap's result is what blocks are to be as good as.
TEST(BlockSweeps, EndAtErrorsLikeTheHeaps) {
  const marching::ExtractedMesh input = ball();
  const std::uint64_t target = input.tets.size() / 5;
  SlimMesh exact = slimOf(input), swept = slimOf(input);
  Options options;
  options.order = Order::kHeap;
  options.target_tets = target;
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  const Stats heap = simplify(exact, options, executor, progress), blocks = run(swept, target, 256, 2);
  EXPECT_LT(blocks.largest_error, 1.5 * heap.largest_error);
  // Where every edge is too dear, nothing is done.
  SlimMesh kept = slimOf(input);
  EXPECT_EQ(run(kept, 0, 256, 1, 1e-9).collapses, 0U);
}

}  // namespace
}  // namespace tet4d::qslim4d
