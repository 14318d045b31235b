// The renderer of tetrahedra against that of dynamic triangles: the same slice from two descriptions.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "libpreprocess/dyntri/dynamic_triangles_builder.h"
#include "player/host/offscreen_gl.h"
#include "player/host/tet_film.h"
#include "player/stream/tet_source.h"
#include "tests/player/picture.h"
#include "tests/player/swept_mesh.h"
#include "tests/player/tet_soup.h"

namespace tet4d {
namespace {

using test::Soup;

// Keeps the pictures.
class Kept final : public host::FrameSink {
 public:
  Status add(const render::Image& image) override { return pictures.push_back(image), Status{}; }
  Status finish() override { return {}; }
  std::vector<render::Image> pictures;
};

std::unique_ptr<render::Renderer> rendererOf(const char* name) {
  auto made = host::makeOffscreenRenderer(name, 1, 1u << 30);
  EXPECT_TRUE(made.ok()) << made.fault().place << ": " << made.fault().what;
  return std::move(made).value();
}

TEST(Tets, DrawWhatDynamicTrianglesDraw) {
  if (!host::hasOffscreenGl()) GTEST_SKIP() << "this build has no off-screen OpenGL";
  const std::vector<double> times{0, 1, 2, 3};
  const Soup made = test::soup(7, 400, 3);
  test::Stage stage(test::writeFile("tets.t4d", {test::trianglesOf(made)}, {{}, times, paged::Codec::kRaw}));
  stage.smooth = false;
  const auto file = hypermesh::File::open(test::writeHypermesh("tets.t4h", made, times));
  ASSERT_TRUE(file.ok());
  stream::TetSource source(file.value(), 1u << 30);
  host::TetFilm film{&file.value(), stage.shot, stage.format, {}};
  for (const double t : {0.0, 0.4, 1.0, 1.7, 2.0, 3.0}) film.times.push_back({t, t});
  Kept kept;
  std::vector<host::TetFrameCost> costs;
  const auto tets = rendererOf("tets");
  const Status status =
      host::playTets(film, source, *tets, &kept, [&](const host::TetFrameCost& cost) { costs.push_back(cost); });
  ASSERT_TRUE(status.ok()) << status.fault().what;
  const auto gl = rendererOf("gl");
  for (std::size_t i = 0; i < film.times.size(); ++i) {
    const auto t = static_cast<float>(film.times[i].frame);
    const scene::DrawList list = stage.list(t);
    EXPECT_EQ(costs[i].drawn, list.drawn()) << t;
    EXPECT_EQ(costs[i].processed, 2 * made.tets.size()) << t;
    const test::Difference d = test::compare(stage.draw(*gl, t), kept.pictures[i]);
    EXPECT_LT(d.rms, 0.1) << t;
    EXPECT_LT(d.share_above_8, 0.0002) << t;
  }
  EXPECT_GT(test::compare(kept.pictures[0], kept.pictures[1]).rms, 5) << "the slice moves";
  EXPECT_EQ(tets->gpuBytes(), 16 * (made.vertices.size() + made.tets.size()));
}

TEST(Tets, BudgetKeepsPicturesAndABadPageIsNamed) {
  if (!host::hasOffscreenGl()) GTEST_SKIP() << "this build has no off-screen OpenGL";
  const std::vector<double> times{0, 1, 2};
  const Soup made = test::soup(9, 50, 2);
  const auto file = hypermesh::File::open(test::writeHypermesh("tets_budget.t4h", made, times));
  ASSERT_TRUE(file.ok());
  const scene::WorldBox box = scene::worldBox(file.value().header().index_to_world, file.value().header().bounds);
  host::TetFilm film{&file.value(), scene::defaultShot(box, 1), {64, 64, 1}, {{0.5, 0.5}, {0.5, 0.5}}};
  Kept kept;
  auto tight = host::makeOffscreenRenderer("tets", 1, 0);
  ASSERT_TRUE(tight.ok());
  stream::TetSource source(file.value(), 0);
  ASSERT_TRUE(host::playTets(film, source, *tight.value(), &kept, [](const host::TetFrameCost&) {}).ok());
  EXPECT_EQ(kept.pictures[0].rgba, kept.pictures[1].rgba);
  scene::DrawList list = scene::makeDrawList(box, film.shot, film.format, false);
  list.surfaces[0].items.push_back({99, 0, 1});
  const std::array<const stream::Residency*, 1> sources{&source};
  const auto refused = tight.value()->draw(list, sources);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.fault().place, "page 99");
}

// The same with bands of lifespans, as dyntri-build writes pages: what one of them alone would leave out is missed.
TEST(Tets, DrawWhatBandsOfLifespansDraw) {
  if (!host::hasOffscreenGl()) GTEST_SKIP() << "this build has no off-screen OpenGL";
  const std::vector<double> times{0, 1, 2, 3};
  const Soup made = test::soup(11, 600, 3);
  const dyntri::BuiltPage page = dyntri::buildPage(made.tets, made.vertices, 6);
  ASSERT_GT(page.bands.size(), 2u);
  const dyntri::PageView views[] = {page.view()};
  test::Stage stage(test::writeViews("tets_bands.t4d", views, {{}, times, paged::Codec::kRaw}));
  stage.smooth = false;
  test::Stage one_run(test::writeFile("tets_one_run.t4d", {test::trianglesOf(made)}, {{}, times, paged::Codec::kRaw}));
  one_run.smooth = false;
  const auto file = hypermesh::File::open(test::writeHypermesh("tets_bands.t4h", made, times));
  ASSERT_TRUE(file.ok());
  stream::TetSource source(file.value(), 1u << 30);
  host::TetFilm film{&file.value(), stage.shot, stage.format, {}};
  for (const double t : {0.0, 0.3, 1.0, 1.6, 2.0, 2.9, 3.0}) film.times.push_back({t, t});
  Kept kept;
  const auto tets = rendererOf("tets"), gl = rendererOf("gl");
  ASSERT_TRUE(host::playTets(film, source, *tets, &kept, [](const host::TetFrameCost&) {}).ok());
  const auto cpu = render::makeCpuRenderer(1);
  for (std::size_t i = 0; i < film.times.size(); ++i) {
    const auto t = static_cast<float>(film.times[i].frame);
    EXPECT_EQ(stage.list(t).drawn(), test::trianglesAlive(made, t, 3)) << t;
    const test::Difference by_gl = test::compare(stage.draw(*gl, t), kept.pictures[i]);
    EXPECT_LT(by_gl.rms, 0.1) << t;
    EXPECT_LT(by_gl.share_above_8, 0.0002) << t;
    EXPECT_LT(test::compare(stage.draw(*cpu, t), one_run.draw(*cpu, t)).rms, 0.1) << t;
  }
}

}  // namespace
}  // namespace tet4d
