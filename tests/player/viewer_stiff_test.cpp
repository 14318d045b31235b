// The player at its edges: odd files, odd times, odd budgets, displays that change, files that do.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>
#include <utility>

#include "player/stream/page_buffer.h"
#include "tests/player/picture.h"
#include "tests/player/viewer_stage.h"

namespace tet4d::host {
namespace {

ViewerOptions small() {
  ViewerOptions options;
  options.width = 800;
  options.height = 500;
  options.samples = 1;
  return options;
}

std::uint64_t drawnAt(test::ViewerStage& stage, double time) {
  stage->state().timeline.setTime(time);
  stage->changed();
  stage.rest();
  return stage->state().stats.drawn;
}

// Writes triangles of one page with the lifespans that their edges give; those of empty ones are left out.
std::string writeTriangles(const std::string& name, test::Page page, const std::vector<double>& times) {
  std::vector<std::pair<dyntri::Lifespan, dyntri::Triangle>> alive;
  for (const dyntri::Triangle& triangle : page.triangles) {
    dyntri::Lifespan life{-1e9f, 1e9f};
    for (const std::uint32_t edge : triangle) {
      life.begin = std::max(life.begin, page.vertices[page.edges[edge].a].t);
      life.end = std::min(life.end, page.vertices[page.edges[edge].b].t);
    }
    if (life.begin < life.end) alive.emplace_back(life, triangle);
  }
  std::stable_sort(alive.begin(), alive.end(),
                   [](const auto& a, const auto& b) { return a.first.begin < b.first.begin; });
  page.triangles.clear();
  for (const auto& [life, triangle] : alive) page.lifespans.push_back(life), page.triangles.push_back(triangle);
  return test::writeFile(name, {page}, {{}, times, paged::Codec::kRaw});
}

// One tetrahedron of space-time, its corners at times 0, 1, 2 and 3: four triangles, each between three of them.
std::string oneTetrahedron(const std::string& name) {
  test::Page page;
  page.vertices = {{0, 0, 0, 0}, {4, 0, 0, 1}, {0, 4, 0, 2}, {0, 0, 4, 3}};
  page.edges = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  page.triangles = {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {2, 4, 5}};
  return writeTriangles(name, page, {0, 1, 2, 3});
}

TEST(ViewerStiff, OneTetrahedronPlays) {
  test::ViewerStage stage(small());
  stage.open(oneTetrahedron("stiff_one.t4d"));
  EXPECT_EQ(drawnAt(stage, 0.5), 1u);
  EXPECT_EQ(drawnAt(stage, 2.5), 1u);
  EXPECT_EQ(drawnAt(stage, 1.5), 2u) << "cut in a quadrilateral";
  EXPECT_EQ(drawnAt(stage, 1), 2u) << "exactly on a frame";
  EXPECT_EQ(drawnAt(stage, 3), 1u) << "at the last moment, which belongs to it";
  stage.type(U' ');
  for (int i = 0; i < 40; ++i) stage->frame(0.05);
  EXPECT_TRUE(stage->state().messages.empty());
}

// Between two frames every tetrahedron reaches from one to the other.
TEST(ViewerStiff, AllAliveAtAllTimes) {
  test::ViewerStage stage(small());
  const std::string path = test::writeTestSphere("stiff_all.t4d", 2);
  const std::uint64_t all = dyntri::File::open(path).value().header().triangles;
  ASSERT_EQ(all, 5120u);
  stage.open(path);
  for (const double time : {0.0, 1e-300, 0.5, 1 - 1e-7, 1.0}) {
    EXPECT_EQ(drawnAt(stage, time), all) << time;
    EXPECT_EQ(stage->state().stats.processed, all) << time;
  }
}

// A tetrahedron that lives all the time, and one that is there from t = 1 to the next float: 1.2e-9 of the whole.
TEST(ViewerStiff, ALifeOfABillionthOfTheWhole) {
  const float next = std::nextafter(1.0f, 2.0f);
  test::Page page;
  page.vertices = {{0, 0, 0, 0}, {4, 0, 0, 33}, {0, 4, 0, 66},   {0, 0, 4, 100},
                   {5, 5, 5, 1}, {9, 5, 5, 1},  {5, 9, 5, next}, {5, 5, 9, next}};
  page.edges = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}, {4, 6}, {4, 7}, {5, 6}, {5, 7}};
  page.triangles = {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {2, 4, 5}, {6, 7, 9}, {6, 9, 8}};
  std::vector<double> times;
  for (int k = 0; k <= 100; ++k) times.push_back(k);
  test::ViewerStage stage(small());
  stage.open(writeTriangles("stiff_billionth.t4d", page, times));
  EXPECT_EQ(drawnAt(stage, std::nextafter(1.0f, 0.0f)), 1u) << "the float before";
  EXPECT_EQ(drawnAt(stage, 1), 3u) << "exactly there";
  EXPECT_EQ(drawnAt(stage, next), 1u) << "half-open";
  EXPECT_EQ(drawnAt(stage, 50), 2u);
  stage.type(U' ');
  for (int i = 0; i < 40; ++i) stage->frame(0.05);
  EXPECT_TRUE(stage->state().messages.empty());
}

TEST(ViewerStiff, OutsideAFilesTimesNothingOfItIsDrawn) {
  test::ViewerStage stage(small());
  const test::Surface ball = test::icosphere(1);
  const auto motion = test::kTestSphere.motion();
  const auto write = [&](const char* name, double from) {
    return test::writeFile(name, {test::sweep(ball, motion, 0, 1)}, {{}, {from, from + 1}, paged::Codec::kRaw});
  };
  stage.open(write("stiff_early.t4d", 0));
  stage.open(write("stiff_late.t4d", 5));
  EXPECT_EQ(drawnAt(stage, 0.5), 320u);
  EXPECT_EQ(drawnAt(stage, 3), 0u) << "between the two";
  EXPECT_EQ(drawnAt(stage, 1), 320u) << "at the first one's last frame";
  EXPECT_EQ(drawnAt(stage, 5), 320u) << "at the second one's first";
  EXPECT_EQ(drawnAt(stage, 1e300), 320u) << "beyond all: the last moment";
  EXPECT_EQ(drawnAt(stage, -1e300), 320u);
  EXPECT_EQ(stage->state().timeline.time(), 0);
}

// A page between two that live: at its times nothing is alive.
TEST(ViewerStiff, NoneAliveInTheMiddle) {
  test::ViewerStage stage(small());
  const test::Surface ball = test::icosphere(1);
  const auto motion = test::kTestSphere.motion();
  stage.open(test::writeFile("stiff_gap.t4d", {test::sweep(ball, motion, 0, 1), test::sweep(ball, motion, 3, 4)},
                             {{}, {0, 1, 2, 3, 4}, paged::Codec::kRaw}));
  EXPECT_EQ(drawnAt(stage, 0.5), 320u);
  EXPECT_EQ(drawnAt(stage, 2), 0u);
  EXPECT_EQ(drawnAt(stage, 1), 0u) << "lifespans are half-open";
  EXPECT_EQ(drawnAt(stage, 3.5), 320u);
  stage.type(U' ');
  for (int i = 0; i < 60; ++i) stage->frame(0.03);
  EXPECT_TRUE(stage->state().messages.empty());
}

TEST(ViewerStiff, BudgetsOfNothingAndOfEverything) {
  for (const double ms : {0.0, std::numeric_limits<double>::infinity()}) {
    for (const std::uint64_t bytes : {std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max()}) {
      ViewerOptions options = small();
      options.budget_bytes = bytes;
      test::ViewerStage stage(options);
      stage.open(test::writeTestSphere("stiff_budget.t4d", 5));
      stage->setBudget(ms, 4);
      stage.type(U' ');
      for (int i = 0; i < 20; ++i) stage->frame(0.05);
      EXPECT_TRUE(stage->state().timeline.playing());
      if (ms > 0) {
        EXPECT_EQ(stage->state().quality.divide, 1u) << "an infinite budget takes nothing away";
      }
      stage.type(U' ');
      stage.rest();
      EXPECT_EQ(stage->state().stats.drawn, 5120u) << "at rest the picture is whole";
      EXPECT_EQ(stage->state().quality.divide, 1u);
      EXPECT_EQ(stage->state().quality.samples, 4u);
      EXPECT_TRUE(stage->state().messages.empty());
    }
  }
}

TEST(ViewerStiff, FilesOpenedLaterTakeTheirShareOfTheSameBudget) {
  ViewerOptions options = small();
  const std::string path = test::writeTestSphere("stiff_share_0.t4d", 9);
  const auto page = stream::PageBuffer::cost(dyntri::File::open(path).value().geometryEntry(0).raw_bytes);
  options.budget_bytes = 6 * page;
  test::ViewerStage stage(options);
  stage.open(path);
  EXPECT_EQ(stage->files().all()[0]->pager->budget(), 6 * page);
  const auto held = [&] {
    std::uint64_t sum = 0;
    for (const auto& file : stage->files().all()) sum += file ? file->pager->totals().held : 0;
    return sum;
  };
  const auto playThrough = [&] {
    std::uint64_t most = 0;
    for (double t = 0; t <= 8; t += 0.5) {
      drawnAt(stage, t);
      most = std::max(most, held());
    }
    return most;
  };
  EXPECT_GT(playThrough(), 2 * page);
  for (int i = 1; i < 3; ++i) {
    const std::string name = test::temporaryDirectory() + "/stiff_share_" + std::to_string(i) + ".t4d";
    std::filesystem::copy_file(path, name, std::filesystem::copy_options::overwrite_existing);
    stage->handle(Dropped{{name}});
    stage.rest();
  }
  ASSERT_EQ(stage->files().count(), 3u);
  for (const auto& file : stage->files().all()) EXPECT_EQ(file->pager->budget(), 2 * page);
  EXPECT_LE(playThrough(), 6 * page) << "three files within the budget of one";
  stage->removeFile(0);
  stage->removeFile(1);
  EXPECT_EQ(stage->files().all()[2]->pager->budget(), 6 * page) << "and what is closed gives its share back";
}

TEST(ViewerStiff, APageThatFailsItsChecksumWhilePlayingIsNamedAndPlayingGoesOn) {
  const std::string path = test::writeTestSphere("stiff_damaged.t4d", 6);
  const std::uint64_t offset = dyntri::File::open(path).value().pages().entries()[2].offset;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(offset + 200));
  file.write("\x7f\x7f\x7f\x7f", 4);
  file.close();
  test::ViewerStage stage(small());
  stage.open(path);
  stage.type(U' ');
  bool passed_through = false, drawn_behind = false;
  for (int i = 0; i < 400 && !drawn_behind; ++i) {
    stage->frame(0.02);
    const double frame = stage->state().timeline.frame();
    passed_through |= frame > 2 && frame < 3;
    drawn_behind = passed_through && frame > 3.2 && stage->state().stats.drawn > 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(drawn_behind) << "pages after it are drawn";
  EXPECT_TRUE(stage->state().timeline.playing());
  ASSERT_EQ(stage->state().messages.size(), 1u);
  EXPECT_NE(stage->state().messages[0].text.find("page 2"), std::string::npos) << stage->state().messages[0].text;
  EXPECT_EQ(stage->state().stats.pages_damaged, 1u);
}

TEST(ViewerStiff, AFileReplacedWhileOpenPlaysOnAndIsSaid) {
  const std::string path = test::writeTestSphere("stiff_replaced.t4d", 6);
  const std::string other = test::writeTestSphere("stiff_replacement.t4d", 3);
  ViewerOptions options = small();
  options.budget_bytes = 1;  // every page is read again
  test::ViewerStage stage(options);
  stage.open(path);
  const std::uint64_t before = drawnAt(stage, 4.5);
  std::filesystem::rename(other, path);
  bool said = false;
  for (int i = 0; i < 200 && !said; ++i) {
    drawnAt(stage, i % 2 == 0 ? 0.5 : 4.5);
    for (const Message& message : stage->state().messages) said |= message.text.find("replaced") != std::string::npos;
  }
  EXPECT_TRUE(said);
  EXPECT_EQ(drawnAt(stage, 4.5), before) << "what was opened plays on";
  stage->handle(Dropped{{path}});
  stage.rest();
  EXPECT_EQ(stage->state().timeline.last(), 2) << "opened again it is the new one";
}

TEST(ViewerStiff, ADisplayThatBecomesDenseMakesLettersAnew) {
  test::ViewerStage stage(small());
  stage.open(test::writeTestSphere("stiff_dense.t4d", 3));
  stage->handle(Resized{1600, 1000, 2});
  stage.rest();
  const render::Image changed = stage.screenshot();
  ViewerOptions options = small();
  options.width = 1600, options.height = 1000, options.scale = 2;
  test::ViewerStage dense(options);
  dense.open(test::writeTestSphere("stiff_dense2.t4d", 3));
  const scene::Frame bar{24, 1000 - 24 - 224, 500, 224};
  const render::Image born = dense.screenshot();
  std::uint64_t differ = 0;
  for (auto y = static_cast<std::uint32_t>(bar.top); y < 976; ++y) {
    for (std::uint32_t x = 24; x < 524; ++x) differ += std::abs(changed.row(y)[4 * x] - born.row(y)[4 * x]) > 8 ? 1 : 0;
  }
  EXPECT_LT(differ, 200u) << "as sharp as if it had been so from the start";
  // A scale that is given holds against the display's.
  options.fixed_scale = true;
  options.scale = 1.5;
  test::ViewerStage fixed(options);
  fixed->handle(Resized{1600, 1000, 3});
  fixed.rest();
  EXPECT_EQ(fixed->state().scale, 1.5);
}

// What a user sees at scale 2 is the picture at scale 1, twice as large: every widget at its place.
TEST(ViewerStiff, ScaleTwoIsScaleOneTwiceAsLarge) {
  test::ViewerStage one(small());
  one.open(test::writeColumnSphere("stiff_scale.t4d", 3));
  const render::Image expected = one.screenshot();
  ViewerOptions options = small();
  options.width *= 2, options.height *= 2, options.scale = 2;
  test::ViewerStage two(options);
  two.open(test::temporaryDirectory() + "/stiff_scale.t4d");
  ASSERT_FALSE(one->state().places.empty());
  for (const auto& [name, place] : one->state().places) {
    ASSERT_TRUE(two->state().places.contains(name)) << name;
    const scene::Frame other = two->state().places.at(name);
    EXPECT_NEAR(place.left, other.left, 1.5) << name;
    EXPECT_NEAR(place.top, other.top, 1.5) << name;
    EXPECT_NEAR(place.width, other.width, 2) << name;
    EXPECT_NEAR(place.height, other.height, 1.5) << name;
  }
  const render::Image large = two.screenshot(), half = render::scaleDown(large, 800, 500);
  EXPECT_LT(test::compare(half, expected).rms, 16) << "letters are drawn finer, not elsewhere";
}

}  // namespace
}  // namespace tet4d::host
