// The renderer of tetrahedra against that of dynamic triangles: the same slice from two descriptions.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>

#include "formats/core/tet_slice.h"
#include "player/host/offscreen_gl.h"
#include "player/host/tet_film.h"
#include "player/stream/tet_source.h"
#include "tests/player/picture.h"
#include "tests/player/swept_mesh.h"

namespace tet4d {
namespace {

using Tets = std::vector<hypermesh::Tet>;

struct Soup {
  std::vector<Vec4f> vertices;
  Tets tets;
};

// Any tetrahedra, with many equal times among them, some of one time altogether.
Soup soup(unsigned seed, std::size_t tets, int frames) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  Soup made;
  for (std::size_t i = 0; i < tets; ++i) {
    const std::array<double, 3> centre{uniform(0, 10), uniform(0, 10), uniform(0, 10)};
    const auto first = static_cast<std::uint32_t>(made.vertices.size());
    for (int k = 0; k < 4; ++k) {
      double t = uniform(0, frames);
      if (random() % 2 == 0) t = std::round(t);
      made.vertices.push_back({static_cast<float>(centre[0] + uniform(-1, 1)),
                               static_cast<float>(centre[1] + uniform(-1, 1)),
                               static_cast<float>(centre[2] + uniform(-1, 1)), static_cast<float>(t)});
    }
    made.tets.push_back({first, first + 1, first + 2, first + 3});
  }
  return made;
}

std::string writeHypermesh(const std::string& name, const Soup& soup, const std::vector<double>& times) {
  const std::string path = test::temporaryDirectory() + "/" + name;
  Bounds4f bounds;
  for (const Vec4f& v : soup.vertices) bounds.add(v);
  hypermesh::MeshHeader header{};
  header.domain = bounds;
  header.domain.max.t = static_cast<float>(times.size() - 1);
  header.index_to_world = AffineMap{};
  auto writer = hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true);
  EXPECT_TRUE(writer.ok());
  EXPECT_TRUE(writer.value().addPage(soup.vertices, {}, soup.tets, bounds).ok());
  EXPECT_TRUE(writer.value().close("{}").ok());
  return path;
}

// Its dynamic triangles, from the rules.
test::Page trianglesOf(const Soup& soup) {
  test::Page page;
  page.vertices = soup.vertices;
  std::vector<std::pair<dyntri::Lifespan, dyntri::Triangle>> triangles;
  for (const hypermesh::Tet& tet : soup.tets) {
    const auto time = [&](std::size_t k) { return soup.vertices[tet[k]].t; };
    const TimeOrder order = orderByTime(time(0), time(1), time(2), time(3));
    for (const DynTriRule& rule : kDynTriRules) {
      const dyntri::Lifespan life{time(order.at[rule.begin]), time(order.at[rule.end])};
      if (!(life.begin < life.end)) continue;
      dyntri::Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& ends = kTetEdges[rule.edges[k]];
        triangle[k] = static_cast<std::uint32_t>(page.edges.size());
        page.edges.push_back({tet[order.at[ends[0]]], tet[order.at[ends[1]]]});
      }
      if (order.odd) std::swap(triangle[1], triangle[2]);
      triangles.emplace_back(life, triangle);
    }
  }
  std::stable_sort(triangles.begin(), triangles.end(),
                   [](const auto& a, const auto& b) { return a.first.begin < b.first.begin; });
  for (const auto& [life, triangle] : triangles) {
    page.lifespans.push_back(life);
    page.triangles.push_back(triangle);
  }
  return page;
}

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
  const Soup made = soup(7, 400, 3);
  test::Stage stage(test::writeFile("tets.t4d", {trianglesOf(made)}, {{}, times, paged::Codec::kRaw}));
  stage.smooth = false;
  const auto file = hypermesh::File::open(writeHypermesh("tets.t4h", made, times));
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
  const Soup made = soup(9, 50, 2);
  const auto file = hypermesh::File::open(writeHypermesh("tets_budget.t4h", made, times));
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

}  // namespace
}  // namespace tet4d
