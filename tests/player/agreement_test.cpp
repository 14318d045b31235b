// The two renderers give the same picture: OpenGL's lookup shader and the CPU's slicer and rasterizer.
//
// Tolerances: RMS below 0.5/255, fewer than 0.1 % of the pixels with a channel that differs by more than 8/255 (pixels
// on silhouettes, where the two disagree about a sample by rounding).
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <glm/vec3.hpp>

#include "player/host/offscreen_gl.h"
#include "player/render/gl_renderer.h"
#include "player/scene/scene_files.h"
#include "tests/player/picture.h"
#include "tests/player/swept_mesh.h"

namespace tet4d {
namespace {

using test::Stage;

constexpr double kMostRms = 0.5, kMostShare = 0.001;

class Agreement : public testing::Test {
 protected:
  void SetUp() override {
    if (!host::hasOffscreenGl()) GTEST_SKIP() << "this build has no off-screen OpenGL";
    auto made = host::makeOffscreenRenderer("gl", 1, 1u << 30);
    ASSERT_TRUE(made.ok()) << made.fault().place << ": " << made.fault().what;
    gl_ = std::move(made).value();
    cpu_ = render::makeCpuRenderer(2);
  }

  void expectSame(Stage& stage, float t, const std::string& what) {
    const test::Difference d = test::compare(stage.draw(*gl_, t), stage.draw(*cpu_, t));
    EXPECT_LT(d.rms, kMostRms) << what << ", t = " << t;
    EXPECT_LT(d.share_above_8, kMostShare) << what << ", t = " << t;
    worst_rms_ = std::max(worst_rms_, d.rms);
    worst_share_ = std::max(worst_share_, d.share_above_8);
  }
  void TearDown() override {
    std::printf("worst rms %.3f/255, worst share of pixels above 8/255 %.4f %%\n", worst_rms_, 100 * worst_share_);
  }

  std::unique_ptr<render::Renderer> gl_, cpu_;
  double worst_rms_ = 0, worst_share_ = 0;
};

TEST_F(Agreement, AtFrameTimesBetweenAndAtTheLastTime) {
  Stage stage(test::writeTestSphere("agree_times.t4d", 4));
  for (const bool smooth : {true, false}) {
    stage.smooth = smooth;
    for (const float t : {0.0f, 0.37f, 1.0f, 1.5f, 2.999f, 3.0f}) expectSame(stage, t, smooth ? "smooth" : "flat");
  }
}

// What a film takes after a fault is the picture before it, not the one that was given up half drawn.
TEST_F(Agreement, APictureThatFailsLeavesTheOneBeforeIt) {
  Stage stage(test::writeTestSphere("agree_fault.t4d", 4));
  for (const std::uint32_t side : {300u, 200u}) {  // the second: another size than the picture that waits
    const render::Image alone = stage.draw(*gl_, 0.37f);
    ASSERT_TRUE(gl_->start(stage.list(0.37f), stage.sources()).ok());
    scene::DrawList broken = stage.list(2.5f);
    broken.format.width = side;
    broken.surfaces[0].items.push_back({1, 0, 1});  // not resident
    EXPECT_FALSE(gl_->start(broken, stage.sources()).ok());
    const auto taken = gl_->take();
    ASSERT_TRUE(taken.ok());
    EXPECT_EQ(taken.value().width, alone.width);
    EXPECT_EQ(taken.value().rgba, alone.rgba) << side;
    EXPECT_EQ(stage.draw(*gl_, 0.37f).rgba, alone.rgba) << "and the next is whole, " << side;
  }
}

TEST_F(Agreement, OrthographicSampledMirroredAndFar) {
  Stage stage(test::writeTestSphere("agree_views.t4d", 2));
  stage.format.samples = 4;
  expectSame(stage, 0.4f, "4 samples");
  stage.shot.view.ortho_height = 14;
  expectSame(stage, 0.4f, "orthographic");
  SetUp();  // a renderer serves one file
  Stage far(
      test::writeTestSphere("agree_far.t4d", 2, {{4e6, -3e6, 5e5}, {{{-0.1, 0, 0}, {0, 0.1, 0.02}, {0, 0, 0.1}}}}));
  expectSame(far, 0.4f, "mirrored, sheared and far");
}

TEST_F(Agreement, WithTheEyeInsideAndTrianglesAcrossTheNearPlane) {
  Stage stage(test::writeTestSphere("agree_inside.t4d", 2));
  stage.shot.view.eye = {8.5, 8, 8};
  stage.shot.view.target = {8.5, 20, 9};
  stage.shot.view.fov_y_degrees = 100;
  expectSame(stage, 0.5f, "inside");
  stage.shot.view.eye = {8.5, 3.9, 8};  // grazing the surface
  stage.shot.view.near_distance = 0.05;
  expectSame(stage, 0.5f, "grazing");
}

TEST_F(Agreement, PagesOfSeveralFrames) {
  const test::Page page = test::sweep(test::icosphere(2), test::kTestSphere.motion(), 0, 3);
  Stage stage(test::writeFile("agree_page.t4d", {page}, {{}, {0, 1, 2, 3}, paged::Codec::kRaw}));
  for (const float t : {0.5f, 1.0f, 2.0f, 2.5f, 3.0f}) expectSame(stage, t, "one page");
}

TEST_F(Agreement, TwoFilesOfOneSceneHideOneAnother) {
  const auto open = [](const std::string& path) { return std::move(dyntri::File::open(path)).value(); };
  // The second one is mirrored, half a radius off, and pierces the first.
  const dyntri::File first = open(test::writeTestSphere("agree_first.t4d", 2));
  const dyntri::File second =
      open(test::writeTestSphere("agree_second.t4d", 2, {{19, 2, 1}, {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}));
  const std::vector<scene::SceneFile> files{{&first, std::nullopt, true}, {&second, std::nullopt, true}};
  scene::DrawList list =
      scene::makeDrawList(files, scene::defaultShot(scene::sceneBox(files), 1.5), {300, 200, 1}, true);
  stream::PageSource a(first, 1u << 30), b(second, 1u << 30);
  const std::size_t pages[] = {0};
  for (stream::PageSource* source : {&a, &b}) ASSERT_TRUE(source->load(0).ok());
  scene::chooseTriangles(a, pages, 0.5f, 1, list.surfaces[0]);
  scene::chooseTriangles(b, pages, 0.5f, 1, list.surfaces[1]);
  const std::array<const stream::Residency*, 2> sources{&a, &b};
  auto by_gl = gl_->draw(list, sources), by_cpu = cpu_->draw(list, sources);
  ASSERT_TRUE(by_gl.ok() && by_cpu.ok());
  const test::Difference d = test::compare(by_gl.value(), by_cpu.value());
  EXPECT_LT(d.rms, kMostRms);
  EXPECT_LT(d.share_above_8, kMostShare);
  list.surfaces[1].items.clear();
  const test::Difference alone = test::compare(cpu_->draw(list, sources).value(), by_cpu.value());
  EXPECT_GT(alone.share_above_8, 0.03) << "the second file is seen";
}

// Phong and glass, several files, several samples a pixel: the first surface is seen through the second one's rim only.
TEST_F(Agreement, GlassAndPhongOfTwoFilesUnderSamples) {
  const auto open = [](const std::string& path) { return std::move(dyntri::File::open(path)).value(); };
  const dyntri::File first = open(test::writeTestSphere("agree_opaque.t4d", 2));
  const dyntri::File second =
      open(test::writeTestSphere("agree_glass.t4d", 2, {{5, 1, 1}, {{{0.9, 0, 0}, {0, 0.9, 0}, {0, 0, 0.9}}}}));
  const std::vector<scene::SceneFile> files{{&first, std::nullopt, true}, {&second, std::nullopt, true}};
  scene::Shot shot = scene::defaultShot(scene::sceneBox(files), 1.5);
  shot.background.checker = 8;
  shot.material.specular = 0.6;
  shot.material.shininess = 60;
  stream::PageSource a(first, 1u << 30), b(second, 1u << 30);
  const std::size_t pages[] = {0};
  for (stream::PageSource* source : {&a, &b}) ASSERT_TRUE(source->load(0).ok());
  const std::array<const stream::Residency*, 2> sources{&a, &b};
  for (const std::uint32_t samples : {1u, 4u, 16u}) {
    scene::DrawList list = scene::makeDrawList(files, shot, {240, 160, samples}, true);
    scene::chooseTriangles(a, pages, 0.5f, 1, list.surfaces[0]);
    scene::chooseTriangles(b, pages, 0.5f, 1, list.surfaces[1]);
    const auto opaque = cpu_->draw(list, sources);
    list.surfaces[1].refraction = 1.33f;
    list.surfaces[1].tint = 0.4f;
    const auto by_gl = gl_->draw(list, sources), by_cpu = cpu_->draw(list, sources);
    ASSERT_TRUE(opaque.ok() && by_gl.ok() && by_cpu.ok());
    const test::Difference d = test::compare(by_gl.value(), by_cpu.value());
    EXPECT_LT(d.rms, kMostRms) << samples << " samples";
    EXPECT_LT(d.share_above_8, 2 * kMostShare) << samples << " samples: edges of the checker add to those of surfaces";
    EXPECT_GT(test::compare(opaque.value(), by_cpu.value()).share_above_8, 0.03) << "one of the two is glass";
  }
}

#ifdef TET4D_HAS_GL

// Normals summed by the driver are those that plain C++ sums, with and without the frame times' merged vertices.
TEST_F(Agreement, NormalsSummedByTheDriver) {
  const auto context = host::makeOffscreenContext();
  ASSERT_TRUE(context.ok());
  std::unique_ptr<render::Renderer> by_driver;
  {
    auto made = render::makeGlRenderer(context.value()->resolver(), 1u << 30, render::GlNormals::kDriver);
    ASSERT_TRUE(made.ok()) << made.fault().what;
    by_driver = std::move(made).value();
  }
  const test::Page page = test::sweep(test::icosphere(3), test::kTestSphere.motion(), 0, 3);
  Stage stage(test::writeFile("agree_normals.t4d", {page}, {{}, {0, 1, 2, 3}, paged::Codec::kRaw}));
  for (const float t : {0.0f, 0.5f, 1.0f, 2.25f, 3.0f}) {
    ASSERT_TRUE(context.value()->makeCurrent());
    const render::Image summed = stage.draw(*by_driver, t);
    const test::Difference d = test::compare(summed, stage.draw(*cpu_, t));
    EXPECT_LT(d.rms, kMostRms) << t;
    EXPECT_LT(d.share_above_8, kMostShare) << t;
    EXPECT_LT(test::compare(summed, stage.draw(*gl_, t)).rms, 0.05) << t;
  }
  ASSERT_TRUE(context.value()->makeCurrent());
  by_driver.reset();
}

#endif

// A run may hold triangles that are dead at t: whatever their edges would cross, nothing of them is drawn.
TEST_F(Agreement, DeadTrianglesOfARunLeaveNothing) {
  const test::Page page = test::sweep(test::icosphere(2), test::kTestSphere.motion(), 0, 3);
  Stage stage(test::writeFile("agree_dead.t4d", {page}, {{}, {0, 1, 2, 3}, paged::Codec::kRaw}));
  for (const bool smooth : {true, false}) {
    stage.smooth = smooth;
    for (const float t : {0.0f, 0.5f, 1.0f, 2.25f, 3.0f}) {
      scene::DrawList list = stage.list(t);
      const auto chosen = gl_->draw(list, stage.sources());
      list.surfaces[0].items = {{0, 0, page.triangles.size()}};
      ASSERT_GT(page.triangles.size(), 2 * list.drawn());
      const auto whole = gl_->draw(list, stage.sources());
      ASSERT_TRUE(chosen.ok() && whole.ok());
      EXPECT_EQ(chosen.value().rgba, whole.value().rgba) << (smooth ? "smooth" : "flat") << ", t = " << t;
    }
  }
}

TEST_F(Agreement, TestCanFail) {
  Stage stage(test::writeTestSphere("agree_fail.t4d", 2));
  const render::Image a = stage.draw(*gl_, 0.4f);
  stage.shot.lights[0].direction.x += 0.15;
  const test::Difference d = test::compare(a, stage.draw(*cpu_, 0.4f));
  EXPECT_TRUE(d.rms >= kMostRms || d.share_above_8 >= kMostShare) << "a light turned by a few degrees must be noticed";
}

}  // namespace
}  // namespace tet4d
