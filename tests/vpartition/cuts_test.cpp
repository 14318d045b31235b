// Every legal cut is closed and covers space-time once: over random cuts, sliced at random times, and as chains.
#include "tests/vpartition/cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/check_patch_dag.h"
#include "tests/qslim4d/closed_slices.h"
#include "tests/vpartition/scenes.h"

namespace tet4d::vpartition::testing {
namespace {

namespace marching = hypermesh::testing;

topology::PatchDagCheck check(const std::string& path) {
  outofcore::MemoryBudget memory;
  outofcore::Progress silent;
  return topology::checkPatchDag(unwrap(patch_dag::File::open(path)), memory, silent);
}

struct Scene {
  const char* name;
  std::array<std::uint64_t, 3> dims;
  std::size_t frames;
  Field field;
  Kind kind;
  bool is_closed;  // within the walls of space
};

std::ostream& operator<<(std::ostream& out, const Scene& scene) { return out << scene.name; }

class Cuts : public ::testing::TestWithParam<Scene> {
 protected:
  void SetUp() override {
    const Scene& scene = GetParam();
    const std::string mesh = marching::temporaryPath("scene.t4h");
    path_ = marching::temporaryPath("scene.t4p");
    input_ = extractScene(mesh, scene.dims, scene.frames, scene.field);
    Options options;
    options.partition = scene.kind;
    options.cell_tets = 3000;
    options.patch_tets = 500;
    buildTo(path_, mesh, options, 2);
    dag_ = load(path_);
  }
  double inputVolume(float t) const {
    SliceMesh slice;
    sliceTets(input_.tets, input_.vertices, {}, t, input_.header.domain.max.t, slice);
    return volumeOf(slice);
  }

  std::string path_;
  marching::ExtractedMesh input_;
  LoadedDag dag_;
};

TEST_P(Cuts, RandomOnesAreClosedAndCoverSpaceTimeOnce) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any_time(0, dag_.domain.max.t);
  std::uniform_real_distribution<double> any_chance(0.3, 1);
  std::set<std::vector<bool>> met;
  std::size_t mixed = 0;
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    const std::vector<bool> refined = randomCut(dag_, random, any_chance(random));
    const std::vector<std::size_t> cut = patchesOf(dag_, refined);
    met.insert(refined);
    std::set<std::uint32_t> levels;
    for (const std::size_t p : cut) levels.insert(dag_.nodes[dag_.patches[p].to].level);
    mixed += levels.size() > 1 ? 1 : 0;
    float t = any_time(random);
    if (i % 4 == 0) t = std::round(t);  // at a frame, where vertices stand close
    const SliceMesh slice = sliceOf(dag_, cut, t);
    ASSERT_EQ(qslim4d::testing::openEdges(slice, dag_.domain), 0U) << "cut " << i << " at " << t;
    if (!GetParam().is_closed) continue;
    const double expected = inputVolume(t);
    worst = std::max(worst, std::abs(volumeOf(slice) - expected) / expected);
  }
  EXPECT_GT(met.size(), 100U) << "cuts that differ";
  EXPECT_GT(mixed, 100U) << "cuts through several levels";
  // A patch twice or not at all would be more; what simplification does to a volume is less.
  EXPECT_LT(worst, 0.15);
}

TEST_P(Cuts, ByErrorAreLegalAndAllChainsMeet) {
  std::vector<double> errors{0};
  for (const auto& node : dag_.nodes) errors.push_back(double{node.error_estimated});
  for (const double error : errors) {
    const std::vector<bool> refined = cutAt(dag_, error);
    for (std::size_t node = 1; node < dag_.nodes.size(); ++node)
      for (const std::uint64_t upper : dag_.uppers[node]) ASSERT_TRUE(!refined[node] || refined[upper]);
  }
  const topology::PatchDagCheck found = check(path_);
  EXPECT_TRUE(found.faults.empty()) << found.faults.front();
  EXPECT_EQ(found.nodes, dag_.nodes.size() - 2);
  EXPECT_EQ(found.cracked_nodes, 0U);
}

// What a patch says that others share is on its border or not: no unshared vertex has its bits in another patch of a
// cut.
TEST_P(Cuts, VerticesThatAreNotSharedStandInNoOtherPatchOfACut) {
  std::mt19937 random(5);
  for (int i = 0; i < 20; ++i) {
    std::set<std::uint64_t> own, seen;
    const std::vector<std::size_t> cut = patchesOf(dag_, randomCut(dag_, random, 0.8));
    for (const std::size_t p : cut) {
      const LoadedDag::Patch& patch = dag_.patches[p];
      for (std::size_t v = 0; v < patch.ids.size(); ++v) {
        if (v >= patch.shared) {
          ASSERT_TRUE(own.insert(patch.ids[v]).second);
        } else {
          seen.insert(patch.ids[v]);
        }
      }
    }
    for (const std::uint64_t id : own) ASSERT_EQ(seen.count(id), 0U);
  }
}

// Through all walls of space, so that cells end in walls.
double waves(double x, double y, double z, double t) {
  return z - 8.7 - 2 * std::sin(0.4 * x + 0.3 * t) * std::cos(0.35 * y);
}

std::string nameOf(const ::testing::TestParamInfo<Scene>& scene) { return scene.param.name; }

INSTANTIATE_TEST_SUITE_P(Scenes, Cuts,
                         ::testing::Values(Scene{"ball", {30, 28, 28}, 9, movingBall, Kind::kVoronoi, true},
                                           Scene{"blobs", {30, 26, 28}, 10, blobs, Kind::kVoronoi, true},
                                           Scene{"blobs_kd", {30, 26, 28}, 10, blobs, Kind::kKd, true},
                                           Scene{"waves", {22, 22, 18}, 10, waves, Kind::kVoronoi, false}),
                         nameOf);

// The check must find what it is there for: a vertex that is moved in one patch by the least that can be.
TEST(CheckPatchDag, ATornBorderIsFoundAndTheNodeNamed) {
  const std::string mesh = marching::temporaryPath("torn.t4h"), path = marching::temporaryPath("torn.t4p");
  extractScene(mesh, {30, 28, 28}, 6, movingBall);
  Options options;
  options.cell_tets = 4000;
  options.patch_tets = 700;
  BuildRun run = buildTo(path, mesh, options);
  ASSERT_TRUE(check(path).faults.empty());
  const hypermesh::File file = unwrap(hypermesh::File::open(mesh));
  patch_dag::Header header{};
  header.flags = file.header().flags;
  header.index_to_world = file.header().index_to_world;
  header.domain = file.header().domain;
  header.isovalue = file.header().isovalue;
  header.time_scale = 1;
  const auto write = [&] {
    outofcore::Progress silent;
    auto writer =
        unwrap(patch_dag::Writer::create(path, header, file.times(), run.dag.nodes, {}, paged::Codec::kRaw, true));
    writeDag(run.dag, writer, silent);
    unwrap(writer.close("{}"));
  };
  // A shared vertex inside the domain, of a patch between two cells, towards the middle so that bounds still hold it.
  const auto torn = std::find_if(run.dag.patches.begin(), run.dag.patches.end(), [&](const StoredPatch& p) {
    return p.upper != 0 && p.lower + 1 != run.dag.nodes.size() && p.shared > 0;
  });
  ASSERT_NE(torn, run.dag.patches.end());
  Vec4f& v = torn->vertices[0];
  const Vec4f before = v;
  v.x = std::nextafter(v.x, 15.0f);
  write();
  EXPECT_GT(check(path).cracked_nodes, 0U);
  EXPECT_FALSE(check(path).faults.empty());
  v = before;
  torn->tets.pop_back();
  write();
  EXPECT_GT(check(path).cracked_nodes, 0U) << "a hole";
}

}  // namespace
}  // namespace tet4d::vpartition::testing
