// Colours by a column, normals of the file and refraction: both renderers against each other and against what is known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "formats/core/color_map.h"
#include "player/host/offscreen_gl.h"
#include "player/render/page_slice.h"
#include "player/render/phong.h"
#include "player/render/slice_columns.h"
#include "player/scene/draw_column.h"
#include "tests/player/picture.h"
#include "tests/player/swept_mesh.h"

namespace tet4d {
namespace {

using test::Stage;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kMostRms = 0.5, kMostShare = 0.001;

// The columns of a file computed from its vertices.
class WithColumns final : public stream::Residency {
 public:
  using Function = std::function<std::vector<float>(const Vec4f&)>;
  WithColumns(const stream::Residency& pages, std::vector<Function> columns)
      : pages_(pages), columns_(std::move(columns)) {}
  const dyntri::PageView* resident(std::size_t page) const override { return pages_.resident(page); }
  std::span<const float> residentColumn(std::size_t page, std::size_t column) const override {
    const dyntri::PageView* view = pages_.resident(page);
    if (view == nullptr || column >= columns_.size()) return {};
    std::vector<float>& rows = kept_[{page, column}];
    if (rows.empty()) {
      for (const Vec4f& v : view->vertices)
        for (const float x : columns_[column](v)) rows.push_back(x);
    }
    return rows;
  }

 private:
  const stream::Residency& pages_;
  std::vector<Function> columns_;
  mutable std::map<std::pair<std::size_t, std::size_t>, std::vector<float>> kept_;
};

scene::DrawColumn columnOf(std::size_t number, std::uint32_t components, int component, float low, float high,
                           const char* map = "viridis") {
  return scene::makeDrawColumn(number, components, component, low, high, *findColorMap(map));
}

class Columns : public testing::Test {
 protected:
  void SetUp() override {
    cpu_ = render::makeCpuRenderer(2);
    if (!host::hasOffscreenGl()) return;
    auto made = host::makeOffscreenRenderer("gl", 1, 1u << 30);
    ASSERT_TRUE(made.ok()) << made.fault().place << ": " << made.fault().what;
    gl_ = std::move(made).value();
  }
  static render::Image draw(render::Renderer& renderer, const scene::DrawList& list, const stream::Residency& source) {
    const std::array<const stream::Residency*, 1> sources{&source};
    auto image = renderer.draw(list, sources);
    EXPECT_TRUE(image.ok()) << (image.ok() ? "" : image.fault().place + ": " + image.fault().what);
    return image.ok() ? std::move(image).value() : render::Image(1, 1);
  }
  // The CPU's picture, after a look at OpenGL's.
  render::Image agreed(const scene::DrawList& list, const stream::Residency& source, const char* what) {
    render::Image by_cpu = draw(*cpu_, list, source);
    if (gl_) {
      const test::Difference d = test::compare(draw(*gl_, list, source), by_cpu);
      EXPECT_LT(d.rms, kMostRms) << what;
      EXPECT_LT(d.share_above_8, kMostShare) << what;
    }
    return by_cpu;
  }

  std::unique_ptr<render::Renderer> cpu_, gl_;
};

// The pixel in the middle, as linear light.
glm::vec3 middleOf(const render::Image& image) {
  const std::uint8_t* p = image.row(image.height / 2) + std::size_t{4} * (image.width / 2);
  return {render::fromSrgb8(p[0]), render::fromSrgb8(p[1]), render::fromSrgb8(p[2])};
}

void unlit(scene::DrawList& list) {
  list.lights.clear();
  list.ambient = glm::vec3(1);
}

TEST(DrawColumnStiff, RangesAtTheEndsOfFloatUnknownsAndLengths) {
  const float largest = std::numeric_limits<float>::max(), infinite = std::numeric_limits<float>::infinity();
  const scene::DrawColumn widest = columnOf(0, 1, 0, largest, -largest);
  EXPECT_EQ(widest.low, -largest) << "swapped";
  EXPECT_LT(glm::distance(colorOf(widest, 0), glm::mix(widest.table[127], widest.table[128], 0.5f)), 1e-4f);
  EXPECT_EQ(colorOf(widest, infinite), widest.above);
  EXPECT_EQ(colorOf(widest, -infinite), widest.below);
  EXPECT_EQ(colorOf(widest, kNaN), widest.unknown);
  const scene::DrawColumn point = columnOf(0, 1, 0, 5, 5);
  EXPECT_EQ(colorOf(point, 4), point.below);
  EXPECT_EQ(colorOf(point, 6), point.above);
  EXPECT_LT(glm::distance(colorOf(point, 5), glm::mix(point.table[127], point.table[128], 0.5f)), 1e-4f);
  float low = infinite, high = -infinite;
  extendRange(std::array{kNaN, infinite, 3.0f, -2.0f, -infinite}, point, low, high);
  EXPECT_EQ(low, -2);
  EXPECT_EQ(high, 3);
  const scene::DrawColumn length = columnOf(0, 3, scene::kMagnitude, 0, 1);
  EXPECT_FLOAT_EQ(columnValue(length, std::array{2.0f, -3.0f, 6.0f}), 7);
}

// A column that is the vertex itself must come out as the position of every slice vertex, to the last bit.
TEST(SliceColumns, AreInterpolatedAsPositionsAre) {
  const test::Page page = test::sweep(test::icosphere(1), test::kTestSphere.motion(), 0, 2);
  const dyntri::PageView view = page.view();
  std::vector<float> rows;
  for (const Vec4f& v : page.vertices) rows.insert(rows.end(), {v.x, v.y, v.z});
  render::PageSlicer slicer;
  render::PageSlice slice;
  for (const float t : {0.0f, 0.3f, 1.0f, 1.999f, 2.0f}) {
    const std::array<scene::DrawItem, 1> all{{{0, 0, page.triangles.size()}}};
    slicer.slice(view, all, t, 2, slice);
    ASSERT_GT(slice.positions.size(), 10u);
    EXPECT_EQ(render::sliceVectors(view, slice.keys, t, rows), slice.positions) << t;
    const auto y = render::sliceValues(view, slice.keys, t, columnOf(0, 3, 1, 0, 1), rows);
    for (std::size_t i = 0; i < y.size(); ++i) EXPECT_EQ(y[i], slice.positions[i].y);
  }
}

TEST_F(Columns, AgreeInEveryKind) {
  Stage stage(test::writeTestSphere("columns_agree.t4d", 3));
  scene::DrawList list = stage.list(1.3f);
  const WithColumns source(stage.source(), {
                                               [](const Vec4f& v) { return std::vector{v.x}; },
                                               [](const Vec4f& v) {
                                                 return std::vector{v.x - 8, v.y - 8, v.t};
                                               },
                                               [](const Vec4f& v) { return std::vector{v.z > 11 ? kNaN : v.z}; },
                                           });
  const render::Image plain = agreed(list, source, "no column");
  list.surfaces[0].column = columnOf(0, 1, 0, 4, 14);
  EXPECT_GT(test::compare(agreed(list, source, "scalar"), plain).rms, 10);
  list.surfaces[0].column = columnOf(1, 3, 1, -3, 3, "cool-warm");  // with values below and above
  agreed(list, source, "component");
  list.surfaces[0].column = columnOf(1, 3, scene::kMagnitude, 0, 8, "inferno");
  agreed(list, source, "length");
  list.surfaces[0].column = columnOf(2, 1, 0, 4, 11);
  agreed(list, source, "not a number");
  list.smooth = false;
  agreed(list, source, "flat");
}

TEST_F(Columns, ShowTheValueInTheMiddle) {
  Stage stage(test::writeTestSphere("columns_middle.t4d", 2));
  stage.shot.view.eye = {8.25, -20, 8};
  stage.shot.view.target = {8.25, 8, 8};
  scene::DrawList list = stage.list(0.5f);
  unlit(list);
  const WithColumns source(stage.source(), {[](const Vec4f& v) { return std::vector{100 * v.y + 10 * v.t}; }});
  list.surfaces[0].column = columnOf(0, 1, 0, 350, 500);
  const float y = 8.25f - 4.25f;  // of the sphere's nearest point
  const glm::vec3 expected = colorOf(*list.surfaces[0].column, 100 * y + 5);
  EXPECT_LT(glm::distance(middleOf(agreed(list, source, "middle")), expected), 0.02f);
}

TEST_F(Columns, OnALogarithmicMapFactorsAreEven) {
  const scene::DrawColumn column = scene::makeDrawColumn(0, 1, 0, 1, 100, *findColorMap("viridis"), {false, true});
  EXPECT_LT(glm::distance(colorOf(column, 10), glm::mix(column.table[127], column.table[128], 0.5f)), 1e-3f);
  EXPECT_EQ(colorOf(column, 0), column.below);
  EXPECT_EQ(colorOf(column, -5), column.below);
  EXPECT_FALSE(scene::makeDrawColumn(0, 1, 0, 0, 1, *findColorMap("viridis"), {false, true}).logarithmic)
      << "zero has no logarithm: linear";
  const scene::DrawColumn turned = scene::makeDrawColumn(0, 1, 0, 0, 1, *findColorMap("viridis"), {true, false});
  EXPECT_EQ(turned.table.front(), column.table.back());
  Stage stage(test::writeTestSphere("columns_log.t4d", 2));
  scene::DrawList list = stage.list(0.5f);
  const WithColumns source(stage.source(), {[](const Vec4f& v) { return std::vector{std::exp(v.x - 4)}; }});
  list.surfaces[0].column = column;
  list.surfaces[0].column->high = 3000;
  const render::Image by_factors = agreed(list, source, "logarithmic");
  list.surfaces[0].column->logarithmic = false;
  EXPECT_GT(test::compare(agreed(list, source, "linear"), by_factors).rms, 5);
}

TEST_F(Columns, WithoutLightColoursAreAsTheyAre) {
  Stage stage(test::writeTestSphere("columns_unlit.t4d", 2));
  scene::DrawList list = stage.list(0.5f);
  list.surfaces[0].lit = false;
  const render::Image image = agreed(list, stage.source(), "unlit");
  EXPECT_LT(glm::distance(middleOf(image), list.surfaces[0].front_color), 0.005f);
  list.surfaces[0].lit = true;
  EXPECT_GT(test::compare(agreed(list, stage.source(), "lit"), image).rms, 3);
}

// Three parts side by side, one in each third of the picture.
TEST_F(Columns, PartsHaveEachItsColour) {
  Stage stage(test::writeParts("columns_parts.t4d"));
  stage.shot.view.eye = {14.25, -60, 4};
  stage.shot.view.target = {14.25, 4, 4};
  stage.shot.view.ortho_height = 20;
  scene::DrawList list = stage.list(0.5f);
  list.surfaces[0].lit = false;
  list.surfaces[0].column = scene::makePartColors();
  const render::Image image = agreed(list, stage.source(), "parts");
  for (std::uint32_t part = 0; part < 3; ++part) {
    const double x = 150 + (4.25 + 10.0 * part - 14.25) * 10;
    const std::uint8_t* p = image.row(100) + std::size_t{4} * static_cast<std::uint32_t>(x);
    const glm::vec3 found(render::fromSrgb8(p[0]), render::fromSrgb8(p[1]), render::fromSrgb8(p[2]));
    EXPECT_LT(glm::distance(found, list.surfaces[0].column->table[part]), 0.01f) << part;
  }
  EXPECT_EQ(scene::partValue(12), 0) << "after twelve they start again";
}

TEST_F(Columns, ThatAreNotThereAreUnknown) {
  Stage stage(test::writeTestSphere("columns_absent.t4d", 2));
  scene::DrawList list = stage.list(0.5f);
  unlit(list);
  const WithColumns source(stage.source(), {[](const Vec4f& v) { return std::vector{v.x}; }});
  list.surfaces[0].column = columnOf(7, 1, 0, 0, 1);
  list.surfaces[0].normal_column = 8;
  EXPECT_LT(glm::distance(middleOf(agreed(list, source, "absent")), list.surfaces[0].column->unknown), 0.01f);
}

// Normals of the file: those of the ideal sphere light it as the slice's do, others do not.
TEST_F(Columns, NormalsOfTheFileLightTheSurface) {
  Stage stage(test::writeTestSphere("columns_normals.t4d", 2));
  const float t = 0.5f;
  scene::DrawList list = stage.list(t);
  const WithColumns source(stage.source(), {[](const Vec4f& v) {
                                              const auto c = test::kTestSphere.centreAt(static_cast<double>(v.t));
                                              const glm::vec3 n = glm::normalize(glm::vec3(
                                                  double(v.x) - c[0], double(v.y) - c[1], double(v.z) - c[2]));
                                              return std::vector{n.x, n.y, n.z};
                                            },
                                            [](const Vec4f&) {
                                              return std::vector{0.0f, 0.0f, 1.0f};
                                            }});
  const render::Image slice = agreed(list, source, "slice");
  list.surfaces[0].normal_column = 0;
  EXPECT_LT(test::compare(agreed(list, source, "file"), slice).rms, 3);
  list.surfaces[0].normal_column = 1;
  EXPECT_GT(test::compare(agreed(list, source, "upward"), slice).rms, 10);
  list.smooth = false;
  const render::Image flat = agreed(list, source, "flat");
  list.surfaces[0].normal_column.reset();
  EXPECT_EQ(test::compare(agreed(list, source, "flat"), flat).largest, 0) << "flat knows no other normals";
}

class Refraction : public Columns {};

TEST_F(Refraction, AgreesAndBends) {
  Stage stage(test::writeTestSphere("refraction.t4d", 2));
  stage.shot.background.checker = 8;
  for (const double index : {1.0, 1.33, 2.4}) {
    stage.shot.material.refraction = index;
    stage.shot.material.tint = 0.3;
    agreed(stage.list(0.5f), stage.source(), "refraction");
  }
  const render::Image near = agreed(stage.list(0.5f), stage.source(), "near background");
  stage.shot.material.depth = 3;
  EXPECT_GT(test::compare(agreed(stage.list(0.5f), stage.source(), "far background"), near).rms, 2);
  stage.shot.material.depth = 0;
  agreed(stage.list(0.5f), stage.source(), "no depth");
  stage.shot.view.ortho_height = 16;
  agreed(stage.list(0.5f), stage.source(), "orthographic");
  stage.shot.view.ortho_height.reset();
  stage.shot.view.eye = {8.5, 8, 8};  // inside: total reflection towards the rim
  stage.shot.view.target = {8.5, 20, 9};
  agreed(stage.list(0.5f), stage.source(), "from inside");
}

// An index of 1 is no glass at all: the picture is the background.
TEST_F(Refraction, IndexOneShowsTheBackgroundUnchanged) {
  Stage stage(test::writeTestSphere("refraction_one.t4d", 2));
  stage.shot.background.checker = 8;
  stage.shot.material.refraction = 1;
  stage.shot.material.specular = 0;
  for (const bool ortho : {false, true}) {
    if (ortho) stage.shot.view.ortho_height = 16;
    scene::DrawList list = stage.list(0.5f);
    const render::Image glass = agreed(list, stage.source(), "index 1");
    list.surfaces[0].items.clear();
    const test::Difference d = test::compare(glass, agreed(list, stage.source(), "background"));
    EXPECT_LT(d.share_above_8, 0.002) << "but for samples at the edges of the checker";
    list = stage.list(0.5f);
    list.surfaces[0].refraction = 1.33f;
    EXPECT_GT(test::compare(glass, draw(*cpu_, list, stage.source())).share_above_8, 0.02) << "water bends";
  }
}

// Seen straight on, a ray is not bent, and ((n - 1) / (n + 1))^2 of the light is mirrored.
TEST_F(Refraction, AtNormalIncidenceRaysGoStraightAndFresnelIsKnown) {
  Stage stage(test::writeTestSphere("refraction_normal.t4d", 2));
  stage.shot.view.eye = {8.5, -20, 8};
  stage.shot.view.target = {8.5, 8.25, 8};
  stage.shot.material.specular = 0;
  stage.shot.background.room.reset();
  stage.shot.background.top = {0, 0, 0};
  stage.shot.background.bottom = {1, 1, 1};
  stage.format = {301, 301, 1};
  scene::DrawList list = stage.list(0.5f);
  list.surfaces[0].refraction = 2;
  const float mirrored = 1.0f / 9, half = render::fromSrgb8(128);  // the sky is mid-grey: mirrored level
  const glm::vec3 found = middleOf(agreed(list, stage.source(), "normal incidence"));
  EXPECT_NEAR(found.x, (1 - mirrored) * half + mirrored * half, 0.02);
  list.background_top = list.background_bottom = glm::vec3(0);
  const scene::DrawSurface& glass = list.surfaces[0];
  render::Image white(3, 3);
  std::fill(white.rgba.begin(), white.rgba.end(), std::uint8_t{255});
  list.perspective = false;
  list.eye_or_backward = {0, -1, 0};
  list.lights.clear();
  const render::Fragment straight{{0, 0, 0}, {0, -1, 0}, 0, true, {1.5f, 1.5f}};
  EXPECT_NEAR(render::shade(list, glass, straight, white).x, 1 - mirrored, 1e-5);
  // From inside beyond the critical angle of 30 degrees all is mirrored: the black sky.
  const render::Fragment steep{{0, 0, 0}, glm::normalize(glm::vec3(1, 1, 0)), 0, false, {1.5f, 1.5f}};
  EXPECT_EQ(render::shade(list, glass, steep, white).x, 0);
}

}  // namespace
}  // namespace tet4d
