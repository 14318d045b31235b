// DAGs of whole scenes: what is in them, that nothing depends on threads, what is refused.
#include "libpreprocess/vpartition/dag_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/check_patch_dag.h"
#include "tests/vpartition/cuts.h"
#include "tests/vpartition/scenes.h"

namespace tet4d::vpartition::testing {
namespace {

namespace marching = hypermesh::testing;

Options small(Kind kind = Kind::kVoronoi) {
  Options options;
  options.partition = kind;
  options.cell_tets = 6000;
  options.patch_tets = 900;
  return options;
}

topology::PatchDagCheck check(const std::string& path) {
  outofcore::MemoryBudget memory;
  outofcore::Progress silent;
  return topology::checkPatchDag(unwrap(patch_dag::File::open(path)), memory, silent);
}

std::string faultsOf(const std::string& path) {
  std::string all;
  for (const std::string& fault : check(path).faults) all += fault + "\n";
  return all;
}

using Corners = std::array<std::array<float, 4>, 4>;

// Tetrahedra by their corners, the least first: the winding does not matter here.
template <class Tets, class Positions>
void addTets(const Tets& tets, const Positions& positions, std::multiset<Corners>& all) {
  for (const auto& tet : tets) {
    Corners corners;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec4f& v = positions[tet[i]];
      corners[i] = {v.x, v.y, v.z, v.t};
    }
    std::sort(corners.begin(), corners.end());
    all.insert(corners);
  }
}

TEST(Dag, TheFinestCutIsTheInputAndTheCoarsestOnePatch) {
  const std::string mesh = marching::temporaryPath("ball.t4h"), path = marching::temporaryPath("ball.t4p");
  const marching::ExtractedMesh input = extractScene(mesh, {30, 28, 28}, 9, movingBall);
  for (const Kind kind : {Kind::kVoronoi, Kind::kKd}) {
    const BuildRun run = buildTo(path, mesh, small(kind));
    EXPECT_GE(run.dag.levels.size(), 4U);
    EXPECT_EQ(run.dag.root_patches, 1U);
    EXPECT_EQ(run.dag.pruned_nodes, 0U);
    const LoadedDag dag = load(path);
    std::multiset<Corners> expected, found;
    addTets(input.tets, input.vertices, expected);
    std::vector<bool> all(dag.nodes.size(), true);
    all.back() = false;
    for (const std::size_t p : patchesOf(dag, all)) addTets(dag.patches[p].tets, dag.patches[p].vertices, found);
    EXPECT_TRUE(expected == found) << "each tetrahedron is owned once";
    for (const LoadedDag::Patch& patch : dag.patches) EXPECT_LE(patch.tets.size(), 900U);
    EXPECT_EQ(patchesOf(dag, cutAt(dag, 1e9)).size(), 1U);
    EXPECT_EQ(faultsOf(path), "");
    // As a rule a level halves what comes in; where cells are this small much is locked.
    for (const LevelReport& level : run.dag.levels) EXPECT_LT(level.tets_out, 0.9 * static_cast<double>(level.tets_in));
  }
}

TEST(Dag, CellsHaveTheSizeAskedFor) {
  const std::string mesh = marching::temporaryPath("blobs.t4h"), path = marching::temporaryPath("blobs.t4p");
  extractScene(mesh, {30, 26, 28}, 12, blobs);
  for (const Kind kind : {Kind::kVoronoi, Kind::kKd}) {
    const BuildRun run = buildTo(path, mesh, small(kind));
    ASSERT_GE(run.dag.levels[0].cells, 8U);
    for (const LevelReport& level : run.dag.levels) {
      EXPECT_LE(level.largest_cell, 2 * 6000U);
      if (level.cells > 1) {
        EXPECT_GE(level.smallest_cell, 6000U / 10);
      }
      EXPECT_GT(level.vertices, 0U);
      EXPECT_EQ(level.locked > 0, level.cells > 1) << "in one cell nothing is locked";
      EXPECT_LT(static_cast<double>(level.locked), 0.75 * static_cast<double>(level.vertices));
    }
    EXPECT_EQ(run.dag.levels.back().cells, 1U);
  }
}

TEST(Dag, BytesDoNotDependOnThreads) {
  const std::string mesh = marching::temporaryPath("same.t4h"), path = marching::temporaryPath("same.t4p");
  extractScene(mesh, {30, 26, 28}, 8, blobs);
  for (const Kind kind : {Kind::kVoronoi, Kind::kKd}) {
    const std::string one = buildTo(path, mesh, small(kind), 1).bytes;
    for (const std::size_t threads : {2U, 5U}) EXPECT_TRUE(buildTo(path, mesh, small(kind), threads).bytes == one);
  }
  Options other = small();
  other.seed = 1;
  EXPECT_FALSE(buildTo(path, mesh, other).bytes == buildTo(path, mesh, small()).bytes)
      << "the seed says where cells are";
}

// Where the time scale is small cells are long in time, where it is large they are short.
TEST(Dag, TheTimeScaleShapesTheCells) {
  const std::string mesh = marching::temporaryPath("scale.t4h"), path = marching::temporaryPath("scale.t4p");
  extractScene(mesh, {26, 26, 26}, 20,
               [](double x, double y, double z, double t) { return ballAt(x, y, z, 12 + 0.1 * t, 12.5, 12, 7); });
  const auto meanDuration = [&](double scale) {
    Options options = small(Kind::kKd);  // without norms of its own, so that the scale alone decides
    options.cell_tets = 15000;
    options.time_scale = scale;
    buildTo(path, mesh, options);
    const patch_dag::File file = unwrap(patch_dag::File::open(path));
    EXPECT_EQ(file.header().time_scale, scale);
    double sum = 0, count = 0;
    for (const auto& node : file.nodes()) {
      if (node.level != 1) continue;
      sum += double{node.bounds.max.t} - double{node.bounds.min.t};
      ++count;
    }
    return sum / count;
  };
  EXPECT_GT(meanDuration(0.1), 2 * meanDuration(3));
}

TEST(Dag, AMeshThatFitsOnePatchIsItsOwnRoot) {
  const std::string mesh = marching::temporaryPath("speck.t4h"), path = marching::temporaryPath("speck.t4p");
  const auto input = extractScene(mesh, {6, 6, 6}, 3, [](double x, double y, double z, double t) {
    return ballAt(x, y, z, 2.5, 2.6, 2.4 + 0.1 * t, 1.2);
  });
  Options options;
  const BuildRun run = buildTo(path, mesh, options);
  ASSERT_LE(input.tets.size(), options.patch_tets);
  EXPECT_TRUE(run.dag.levels.empty());
  EXPECT_EQ(run.dag.nodes.size(), 2U);
  EXPECT_EQ(run.dag.patches.size(), 1U);
  EXPECT_EQ(faultsOf(path), "");
  // And nothing at all is a file, too.
  extractScene(mesh, {6, 6, 6}, 3, [](double, double, double, double) { return -1.0; });
  EXPECT_EQ(buildTo(path, mesh, options).dag.patches.size(), 0U);
  EXPECT_EQ(faultsOf(path), "");
}

// What does not move costs nothing: refinements that change nothing are left out.
TEST(Dag, RefinementsWithoutErrorAreLeftOut) {
  const std::string mesh = marching::temporaryPath("still.t4h"), path = marching::temporaryPath("still.t4p");
  // Planes are exact in f32, and at rest: flat in space-time.
  const auto input = extractScene(mesh, {17, 17, 17}, 24, [](double x, double y, double z, double) {
    return 3.5 - std::max({std::abs(x - 8), std::abs(y - 8), std::abs(z - 8)});
  });
  const BuildRun run = buildTo(path, mesh, small());
  EXPECT_GT(run.dag.pruned_nodes, 0U);
  const patch_dag::File file = unwrap(patch_dag::File::open(path));
  EXPECT_LT(file.header().leaf_tets, input.tets.size() / 2);
  EXPECT_EQ(faultsOf(path), "");
  // Slices are the cube's all the same.
  const LoadedDag dag = load(path);
  std::vector<bool> all(dag.nodes.size(), true);
  all.back() = false;
  for (const float t : {0.0f, 3.5f, 11.25f, 23.0f}) {
    const double volume = volumeOf(sliceOf(dag, patchesOf(dag, all), t));
    SliceMesh slice;
    sliceTets(input.tets, input.vertices, {}, t, input.header.domain.max.t, slice);
    EXPECT_NEAR(volume, volumeOf(slice), 1e-3 * volumeOf(slice)) << t;
  }
}

TEST(Dag, OptionsOutOfRangeAndPartsAreRefused) {
  const std::string mesh = marching::temporaryPath("bad.t4h"), path = marching::temporaryPath("bad.t4p");
  extractScene(mesh, {10, 10, 10}, 3, [](double x, double y, double z, double) { return ballAt(x, y, z, 5, 5, 5, 3); });
  const auto code = [&](const Options& options) {
    try {
      buildTo(path, mesh, options);
    } catch (const Error& error) {
      EXPECT_FALSE(error.fault().remedy.empty());
      return error.fault().code;
    }
    return FaultCode::kIo;
  };
  Options options;
  options.patch_tets = kMostPatchTets + 1;
  EXPECT_EQ(code(options), FaultCode::kUsage);
  options = {};
  options.cell_tets = 10;
  EXPECT_EQ(code(options), FaultCode::kUsage);
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    options = {};
    options.time_scale = scale;
    EXPECT_EQ(code(options), FaultCode::kUsage);
  }
}

TEST(Dag, TooLittleMemoryIsSaidBeforeItBegins) {
  const std::string mesh = marching::temporaryPath("large.t4h");
  extractScene(mesh, {20, 20, 20}, 4, [](double x, double y, double z, double) { return ballAt(x, y, z, 9, 9, 9, 7); });
  outofcore::ThreadExecutor executor(1);
  outofcore::MemoryBudget memory(1 << 20);
  outofcore::Progress silent;
  try {
    buildDag(unwrap(hypermesh::File::open(mesh)), {}, executor, memory, silent);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kOutOfMemory);
  }
}

}  // namespace
}  // namespace tet4d::vpartition::testing
