#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "libpreprocess/dyntri/dynamic_triangles_builder.h"
#include "player/scene/dyntri_chooser.h"
#include "player/scene/scene_files.h"
#include "player/stream/page_source.h"
#include "tests/player/swept_mesh.h"
#include "tests/player/tet_soup.h"

namespace tet4d::scene {
namespace {

const Format kFormat{320, 200, 1};

dyntri::File openFile(const std::string& path) {
  auto file = dyntri::File::open(path);
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.fault().what);
  return std::move(file).value();
}

DrawList cameraFor(const dyntri::File& file) {
  const WorldBox box = worldBox(file.header().index_to_world, file.header().bounds);
  return makeDrawList(box, defaultShot(box, 1.6), kFormat, true);
}

TEST(DrawList, DefaultCameraShowsAllCornersAndFillsThePicture) {
  const AffineMap map{{100, -50, 3}, {{{2, 0, 0}, {0, 0.5, 0}, {0, 0.25, 1}}}};
  const WorldBox box = worldBox(map, {{0, 0, 0, 0}, {10, 20, 30, 1}});
  const DrawList list = makeDrawList(box, defaultShot(box, 1.6), kFormat, true);
  double widest = 0;
  for (const glm::dvec3& corner : box.corners) {
    const glm::vec4 clip = list.relative_to_clip * glm::vec4(glm::vec3(corner), 1);
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(clip[axis]), clip.w);
    widest = std::max({widest, std::abs(double(clip.x / clip.w)), std::abs(double(clip.y / clip.w))});
  }
  EXPECT_GT(widest, 0.85);
}

TEST(DrawList, FarOriginCostsNoPrecision) {
  const Bounds4f bounds{{0, 0, 0, 0}, {10, 10, 10, 1}};
  const AffineMap near_map{{0, 0, 0}, {{{0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}}}};
  AffineMap far_map = near_map;
  far_map.origin = {4.5e6, -3e6, 6e5};
  const auto listFor = [&](const AffineMap& map) {
    const WorldBox box = worldBox(map, bounds);
    return makeDrawList(box, defaultShot(box, 1.6), kFormat, true);
  };
  const DrawList near_list = listFor(near_map), far_list = listFor(far_map);
  const glm::vec4 p(0.05f, 0.04f, -0.03f, 1);
  const glm::vec4 a = near_list.relative_to_clip * p, b = far_list.relative_to_clip * p;
  // A double at 4.5e6 resolves 1e-9: relative to the box of 0.1 that is 1e-8 of the picture.
  EXPECT_NEAR(a.x / a.w, b.x / b.w, 2e-6);
  EXPECT_NEAR(a.y / a.w, b.y / b.w, 2e-6);
  EXPECT_NEAR(a.z / a.w, b.z / b.w, 2e-5);
}

TEST(DrawList, NormalsPointOutUnderAMirrorMap) {
  const AffineMap mirror{{0, 0, 0}, {{{-2, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  const WorldBox box = worldBox(mirror, {{-1, -1, -1, 0}, {1, 1, 1, 1}});
  const DrawList list = makeDrawList(box, defaultShot(box, 1), kFormat, true);
  EXPECT_TRUE(list.surfaces[0].mirrored);
  // Outwards in index space at (1, 0, 0) is +x there; in the world that place is at -2 and outwards is -x.
  EXPECT_LT((list.surfaces[0].normal_to_relative * glm::vec3(1, 0, 0)).x, 0);
}

TEST(DrawList, EmptyAndFlatBoxesGiveFiniteMatrices) {
  for (const Bounds4f& bounds :
       {Bounds4f{}, Bounds4f{{0, 0, 0, 0}, {0, 0, 0, 0}}, Bounds4f{{0, 0, 0, 0}, {5, 5, 0, 1}}}) {
    const WorldBox box = worldBox({}, bounds);
    const DrawList list = makeDrawList(box, defaultShot(box, 1), kFormat, true);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) EXPECT_TRUE(std::isfinite(list.relative_to_clip[i][j]));
    }
  }
}

TEST(Chooser, PagesByHalfOpenIntervalsClosedAtTheLastTime) {
  const dyntri::File file = openFile(test::writeTestSphere("chooser_time.t4d", 4));
  const DrawList camera = cameraFor(file);
  const auto at = [&](float t) { return choosePages(file.geometryEntries(), t, 3, camera, camera.surfaces[0]); };
  using Pages = std::vector<std::size_t>;
  EXPECT_EQ(at(0), Pages{0});
  EXPECT_EQ(at(0.999f), Pages{0});
  EXPECT_EQ(at(1), Pages{1});
  EXPECT_EQ(at(2), Pages{2});
  EXPECT_EQ(at(3), Pages{2}) << "the last time is closed";
  EXPECT_EQ(at(3.001f), Pages{});
  EXPECT_EQ(at(-0.001f), Pages{});
}

TEST(Chooser, PagesOutsideTheViewAreCulled) {
  // Two spheres far apart, each a page of its own over the same time.
  const test::Surface ball = test::icosphere(1);
  const test::MovingSphere left{{0, 0, 0}, {0, 0, 0}, 1, 0}, right{{100, 0, 0}, {0, 0, 0}, 1, 0};
  const dyntri::File file = openFile(test::writeFile(
      "chooser_view.t4d", {test::sweep(ball, left.motion(), 0, 1), test::sweep(ball, right.motion(), 0, 1)},
      {{}, {0, 1}, paged::Codec::kRaw}));
  const WorldBox box = worldBox({}, file.header().bounds);
  Shot shot = defaultShot(box, 1.6);
  const auto chosen = [&] {
    const DrawList camera = makeDrawList(box, shot, kFormat, true);
    return choosePages(file.geometryEntries(), 0.5f, 1, camera, camera.surfaces[0]);
  };
  using Pages = std::vector<std::size_t>;
  EXPECT_EQ(chosen(), (Pages{0, 1}));
  shot.view.eye = {0, -10, 0};
  shot.view.target = {0, 0, 0};
  EXPECT_EQ(chosen(), Pages{0});
  shot.view.eye = {100, -10, 0};
  shot.view.target = {100, 0, 0};
  EXPECT_EQ(chosen(), Pages{1});
  shot.view.target = {100, -20, 0};
  EXPECT_EQ(chosen(), Pages{}) << "all behind the eye";
  shot.view = {};
  shot.view.eye = {0, -10, 0};
  shot.view.ortho_height = 4;
  EXPECT_EQ(chosen(), Pages{0});
}

TEST(Chooser, CountsAreExactAndNothingAliveIsLeftOut) {
  // One page over three frames, so that its triangles begin at different times.
  const test::Page page = test::sweep(test::icosphere(2), test::kTestSphere.motion(), 0, 3);
  const dyntri::File file =
      openFile(test::writeFile("chooser_counts.t4d", {page}, {{}, {0, 1, 2, 3}, paged::Codec::kRaw}));
  stream::PageSource source(file, 1u << 30);
  ASSERT_TRUE(source.load(0).ok());
  const std::size_t pages[] = {0};
  for (const float t : {0.0f, 0.25f, 1.0f, 1.5f, 2.0f, 2.999f, 3.0f}) {
    DrawList list = cameraFor(file);
    DrawSurface& surface = list.surfaces[0];
    chooseTriangles(source, pages, t, 3, surface);
    std::uint64_t alive = 0, first = page.triangles.size(), last = 0;
    for (std::size_t i = 0; i < page.lifespans.size(); ++i) {
      const auto [begin, end] = page.lifespans[i];
      if (!((begin <= t && t < end) || (t == 3 && end == 3))) continue;
      ++alive;
      first = std::min<std::uint64_t>(first, i);
      last = std::max<std::uint64_t>(last, i);
    }
    ASSERT_GT(alive, 0u) << t;
    EXPECT_EQ(surface.drawn, alive) << t;
    ASSERT_EQ(surface.items.size(), 1u);
    EXPECT_EQ(surface.items[0].first, first);
    EXPECT_EQ(surface.items[0].count, last - first + 1);
    EXPECT_EQ(surface.processed, surface.items[0].count);
    EXPECT_LT(surface.processed, page.triangles.size()) << "the other frames' triangles are not handed over";
  }
}

// A page as dyntri-build writes it: a run of each band. Counted against the tetrahedra, not against the page.
TEST(Chooser, RunsOfBandsHoldEveryLivingTriangleOnce) {
  const test::Soup made = test::soup(3, 600, 3);
  const dyntri::BuiltPage page = dyntri::buildPage(made.tets, made.vertices, 6);
  const dyntri::PageView views[] = {page.view()};
  const dyntri::File file =
      openFile(test::writeViews("chooser_bands.t4d", views, {{}, {0, 1, 2, 3}, paged::Codec::kRaw}));
  stream::PageSource source(file, 1u << 30);
  ASSERT_TRUE(source.load(0).ok());
  ASSERT_GT(source.resident(0)->bands.size(), 2u);
  const std::size_t pages[] = {0};
  std::uint64_t processed = 0, drawn = 0;
  for (const float t : {0.0f, 0.25f, 0.5f, 1.0f, 1.7f, 2.0f, 2.5f, 2.999f, 3.0f}) {
    DrawList list = cameraFor(file);
    DrawSurface& surface = list.surfaces[0];
    chooseTriangles(source, pages, t, 3, surface);
    EXPECT_EQ(surface.drawn, test::trianglesAlive(made, t, 3)) << t;
    std::vector<int> times_drawn(page.triangles.size(), 0);
    for (const DrawItem& item : surface.items) {
      for (std::uint64_t i = item.first; i < item.first + item.count; ++i) ++times_drawn.at(i);
    }
    for (std::size_t i = 0; i < page.lifespans.size(); ++i) {
      const auto [begin, end] = page.lifespans[i];
      const bool alive = (begin <= t && t < end) || (t == 3 && end == 3);
      EXPECT_LE(times_drawn[i], 1) << t;
      EXPECT_GE(times_drawn[i], alive ? 1 : 0) << "triangle " << i << " at " << t;
    }
    processed += surface.processed;
    drawn += surface.drawn;
  }
  EXPECT_LT(processed, 2 * drawn) << "few dead ones are handed over";
  EXPECT_LT(drawn, processed);
}

TEST(Chooser, AbsentPagesAreCountedAndNotDrawn) {
  const dyntri::File file = openFile(test::writeTestSphere("chooser_absent.t4d", 3));
  stream::PageSource source(file, 1u << 30);
  DrawList list = cameraFor(file);
  const std::size_t pages[] = {0};
  chooseTriangles(source, pages, 0.5f, 2, list.surfaces[0]);
  EXPECT_EQ(list.absent(), 1u);
  EXPECT_TRUE(list.surfaces[0].items.empty());
}

dyntri::File ballAt(const std::string& name, const AffineMap& map, const std::vector<double>& times) {
  std::vector<test::Page> pages;
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const auto begin = static_cast<int>(k);
    pages.push_back(test::sweep(test::icosphere(1), test::MovingSphere{}.motion(), begin, begin + 1));
  }
  return openFile(test::writeFile(name, pages, {map, times, paged::Codec::kRaw}));
}

TEST(SceneFiles, OneBoxOneTimeAndEachFileInItsPlace) {
  AffineMap left, right;
  left.origin = {-5, 0, 0};
  right.origin = {5, 0, 0};
  right.axes[0] = {-2, 0, 0};
  const dyntri::File a = ballAt("scene_left.t4d", left, {0, 1, 2}), b = ballAt("scene_right.t4d", right, {1, 1.5, 4});
  const std::vector<SceneFile> files{{&a, std::nullopt, true}, {&b, std::nullopt, true}};
  const WorldBox box = sceneBox(files);
  EXPECT_NEAR(box.centre.x, 0.5 * (-6 + 7), 1e-6);
  EXPECT_NEAR(box.corners[1].x, 6.5, 1e-6);
  EXPECT_EQ(sceneTimes(files), (std::vector<double>{0, 1, 1.5, 2, 4}));
  EXPECT_EQ(frameAt(a, 0.5), 0.5f);
  EXPECT_EQ(frameAt(b, 0.5), std::nullopt);
  EXPECT_EQ(frameAt(b, 2.75), 1.5f);
  EXPECT_EQ(frameAt(a, 2), 2.0f);
  EXPECT_EQ(frameAt(a, 2.1), std::nullopt);
  Shot shot = defaultShot(box, 1.6);
  const DrawList list = makeDrawList(files, shot, kFormat, true);
  ASSERT_EQ(list.surfaces.size(), 2u);
  const auto place = [](const DrawSurface& s, const glm::vec3& index) {
    return s.index_to_relative * (index - s.index_centre) + s.offset;
  };
  EXPECT_NEAR(place(list.surfaces[0], {1, 0, 0}).x, -4 - box.centre.x, 1e-6);
  EXPECT_NEAR(place(list.surfaces[1], {1, 0, 0}).x, 3 - box.centre.x, 1e-6);
  EXPECT_FALSE(list.surfaces[0].mirrored);
  EXPECT_TRUE(list.surfaces[1].mirrored);
  EXPECT_NE(list.surfaces[0].front_color, list.surfaces[1].front_color);
}

TEST(SceneFilesStiff, FarFromTheOriginAndApart) {
  AffineMap near_map, far_map;
  near_map.origin = {4.5e6, -3e6, 0};
  far_map.origin = {4.5e6 + 1e3, -3e6, 0};
  const dyntri::File a = ballAt("scene_far_a.t4d", near_map, {1.7e9, 1.7e9 + 1e-3});
  const dyntri::File b = ballAt("scene_far_b.t4d", far_map, {1.7e9, 1.7e9 + 1e-3});
  const std::vector<SceneFile> files{{&a, std::nullopt, true}, {&b, std::nullopt, true}};
  const WorldBox box = sceneBox(files);
  const DrawList list = makeDrawList(files, defaultShot(box, 1.6), kFormat, true);
  const glm::vec3 apart = list.surfaces[1].offset - list.surfaces[0].offset;
  EXPECT_NEAR(apart.x, 1e3, 1e-3);
  EXPECT_EQ(frameAt(a, a.times()[1]), 1.0f);
  EXPECT_TRUE(sceneBox(std::vector<SceneFile>{}).radius() == 0);
}

}  // namespace
}  // namespace tet4d::scene
