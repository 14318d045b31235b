// Stiff and extreme scenes: the DAG is sound, every cut closed, or the refusal is clear.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/check_patch_dag.h"
#include "tests/vpartition/cuts.h"
#include "tests/vpartition/scenes.h"

namespace tet4d::vpartition::testing {
namespace {

namespace marching = hypermesh::testing;

struct Outcome {
  BuildRun run;
  topology::PatchDagCheck check;
};

Outcome buildScene(std::array<std::uint64_t, 3> dims, std::size_t frames, const Field& field, Options options,
                   const AffineMap& map = {}) {
  const std::string mesh = marching::temporaryPath("stiff.t4h"), path = marching::temporaryPath("stiff.t4p");
  extractScene(mesh, dims, frames, field, map);
  Outcome outcome;
  outcome.run = buildTo(path, mesh, options, 2);
  const patch_dag::File file = unwrap(patch_dag::File::open(path));
  unwrap(file.verify());
  outofcore::MemoryBudget memory;
  outofcore::Progress silent;
  outcome.check = topology::checkPatchDag(file, memory, silent);
  EXPECT_TRUE(outcome.check.faults.empty()) << outcome.check.faults.front();
  return outcome;
}

Options small() {
  Options options;
  options.cell_tets = 4000;
  options.patch_tets = 700;
  return options;
}

TEST(DagStiff, AllMotionInOneCorner) {
  const Outcome outcome = buildScene(
      {40, 24, 24}, 12,
      [](double x, double y, double z, double t) {
        return std::max(ballAt(x, y, z, 9, 12, 12, 7.3), ballAt(x, y, z, 33 - 0.2 * t, 12 + std::sin(t), 12, 4.2));
      },
      small());
  EXPECT_EQ(outcome.run.dag.root_patches, 1U);
}

TEST(DagStiff, TwoFrames) {
  const Outcome outcome = buildScene(
      {30, 30, 30}, 2, [](double x, double y, double z, double t) { return ballAt(x, y, z, 14.5 + t, 14, 14, 11); },
      small());
  EXPECT_EQ(outcome.run.dag.root_patches, 1U);
}

// Time that counts for nothing, and for far more than it should: norms of their own bring cells back by a factor of 8.
TEST(DagStiff, TimeScalesApart) {
  const Field field = [](double x, double y, double z, double t) { return ballAt(x, y, z, 10 + 0.2 * t, 11, 11, 6.3); };
  for (const double scale : {1e-9, 1e-2, 8.0}) {
    Options options = small();
    options.time_scale = scale;
    EXPECT_EQ(buildScene({22, 22, 22}, 10, field, options).run.dag.root_patches, 1U) << scale;
  }
  // Cells of single frames have little but border. That is said, not written.
  Options options = small();
  options.time_scale = 1e9;
  try {
    buildScene({22, 22, 22}, 10, field, options);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(error.fault().what.find("% of the vertices locked"), std::string::npos) << error.fault().what;
    EXPECT_NE(error.fault().remedy.find("--time-scale"), std::string::npos);
  }
}

TEST(DagStiff, SpecksThatCannotBecomeFewer) {
  // Each speck is one sample of one frame: eight tetrahedra or a few more that no collapse may take away.
  const std::string mesh = marching::temporaryPath("specks.t4h"), path = marching::temporaryPath("specks.t4p");
  extractScene(mesh, {32, 32, 32}, 9, [](double x, double y, double z, double t) {
    const auto odd = [](double v) { return static_cast<long>(v) % 4 == 2; };
    return odd(x) && odd(y) && odd(z) && odd(t) ? 0.6 : -0.4;
  });
  try {
    const BuildRun run = buildTo(path, mesh, small(), 2);
    // What could be made coarser is sound, and a root that is more than a patch is told.
    EXPECT_GE(run.dag.levels.size(), 1U);
    EXPECT_LT(run.dag.levels[0].tets_out, 0.9 * static_cast<double>(run.dag.levels[0].tets_in));
    unwrap(unwrap(patch_dag::File::open(path)).verify());
  } catch (const Error& error) {
    EXPECT_NE(error.fault().what.find("cannot be made coarser"), std::string::npos) << error.fault().what;
    EXPECT_FALSE(error.fault().remedy.empty());
  }
}

// Cells so small that nearly all of their vertices are locked: one resolution is no DAG.
TEST(DagStiff, AGraphOfOneLevelIsRefused) {
  const std::string mesh = marching::temporaryPath("locked.t4h"), path = marching::temporaryPath("locked.t4p");
  extractScene(mesh, {24, 24, 24}, 6,
               [](double x, double y, double z, double t) { return ballAt(x, y, z, 11 + 0.3 * t, 12, 12, 8.3); });
  Options options;
  options.cell_tets = options.patch_tets = 60;
  try {
    buildTo(path, mesh, options, 2);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kBadInput);
    EXPECT_NE(error.fault().what.find("cannot be made coarser"), std::string::npos) << error.fault().what;
    EXPECT_NE(error.fault().what.find("% of the vertices locked"), std::string::npos);
    EXPECT_NE(error.fault().remedy.find("--cell-tets"), std::string::npos);
  }
}

// Cells that were masked leave a free boundary, which is simplified too: cracks are told from it.
TEST(DagStiff, AnInnerBoundary) {
  const Outcome outcome = buildScene(
      {30, 28, 28}, 9,
      [](double x, double y, double z, double t) {
        if (x > 12 && x < 17 && y > 15 && t > 2 && t < 6) return std::nan("");
        return movingBall(x, y, z, t);
      },
      small());
  EXPECT_GT(outcome.check.open_faces, 0U);
  EXPECT_GE(outcome.run.dag.levels.size(), 3U);
}

TEST(DagStiff, FarFromTheOriginInFlatCells) {
  const AffineMap map{{1e7, -1e7, 3e8}, {{{0.5, 0, 0}, {0, 20, 0}, {0, 0, -2}}}};
  const Outcome outcome = buildScene(
      {26, 26, 26}, 8,
      [](double x, double y, double z, double t) { return ballAt(x, y, z, 12 + 0.2 * t, 12.5, 12, 7.2); }, small(),
      map);
  EXPECT_EQ(outcome.run.dag.root_patches, 1U);
}

}  // namespace
}  // namespace tet4d::vpartition::testing
