// What a picture must show, known from geometry alone; for every renderer of this build.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "player/host/offscreen_gl.h"
#include "player/render/page_slice.h"
#include "tests/player/picture.h"
#include "tests/player/swept_mesh.h"

namespace tet4d {
namespace {

using test::Sides;
using test::Stage;

class Picture : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    auto made = host::makeOffscreenRenderer(GetParam(), 2, 1u << 30);
    ASSERT_TRUE(made.ok()) << made.fault().what;
    renderer_ = std::move(made).value();
  }
  render::Renderer& renderer() { return *renderer_; }

 private:
  std::unique_ptr<render::Renderer> renderer_;
};

std::vector<const char*> renderersOfThisBuild() {
  return host::hasOffscreenGl() ? std::vector<const char*>{"cpu", "gl"} : std::vector<const char*>{"cpu"};
}
INSTANTIATE_TEST_SUITE_P(All, Picture, testing::ValuesIn(renderersOfThisBuild()),
                         [](const auto& renderer) { return std::string(renderer.param); });

// A closed surface shows no inside from outside. Of triangles seen edge-on Mesa decides the side before it rounds the
// corners to sub-pixels, so a few samples on the silhouette may differ.
constexpr std::uint64_t kSilhouetteSpecks = 8;

glm::dvec3 toGlm(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

// A camera that looks at a sphere's centre along y from `distance`.
void lookAlongY(scene::Shot& shot, const glm::dvec3& centre, double distance) {
  shot.view.target = centre;
  shot.view.eye = centre - glm::dvec3(0, distance, 0);
}

TEST_P(Picture, OrthographicDiscOfASphereHasItsArea) {
  Stage stage(test::writeTestSphere("disc_ortho.t4d", 4));
  test::paintSides(stage.shot);
  stage.format = {400, 400, 1};
  for (const float t : {0.0f, 0.6f, 1.0f, 2.25f, 3.0f}) {
    lookAlongY(stage.shot, toGlm(test::kTestSphere.centreAt(t)), 50);
    stage.shot.view.ortho_height = 16;
    const Sides sides = test::countSides(stage.draw(renderer(), t));
    const double radius_px = test::kTestSphere.radiusAt(t) * 400 / 16;
    const double expected = std::numbers::pi * radius_px * radius_px;
    EXPECT_NEAR(static_cast<double>(sides.front), expected, 0.01 * expected) << t;
    EXPECT_LE(sides.back, kSilhouetteSpecks) << t;
  }
}

TEST_P(Picture, PerspectiveDiscOfASphereHasItsArea) {
  Stage stage(test::writeTestSphere("disc_perspective.t4d", 3));
  test::paintSides(stage.shot);
  stage.format = {400, 400, 1};
  stage.shot.view.fov_y_degrees = 40;
  for (const float t : {0.5f, 1.7f}) {
    const double distance = 20, radius = test::kTestSphere.radiusAt(t);
    lookAlongY(stage.shot, toGlm(test::kTestSphere.centreAt(t)), distance);
    const Sides sides = test::countSides(stage.draw(renderer(), t));
    const double tangent = radius / std::sqrt(distance * distance - radius * radius);
    const double radius_px = tangent / std::tan(glm::radians(20.0)) * 200;
    const double expected = std::numbers::pi * radius_px * radius_px;
    EXPECT_NEAR(static_cast<double>(sides.front), expected, 0.01 * expected) << t;
    EXPECT_LE(sides.back, kSilhouetteSpecks);
  }
}

TEST_P(Picture, MirroredAndShearedMapsKeepOutsideOutside) {
  const AffineMap maps[] = {{{1e5, 2e5, -3e5}, {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
                            {{0, 0, 0}, {{{0.01, 0.002, 0}, {0, 0.01, 0.001}, {0.003, 0, 0.02}}}}};
  for (const AffineMap& map : maps) {
    Stage stage(test::writeTestSphere("maps.t4d", 2, map));
    test::paintSides(stage.shot);
    const Sides sides = test::countSides(stage.draw(renderer(), 0.5f));
    EXPECT_GT(sides.front, 5000u);
    EXPECT_LE(sides.back, kSilhouetteSpecks);
  }
}

TEST_P(Picture, InsideIsLitFromWithin) {
  Stage stage(test::writeTestSphere("inside.t4d", 2));
  const glm::dvec3 centre = toGlm(test::kTestSphere.centreAt(0.5));
  stage.shot.view.eye = centre;
  stage.shot.view.target = centre + glm::dvec3(0, 1, 0);
  test::paintSides(stage.shot);
  const Sides sides = test::countSides(stage.draw(renderer(), 0.5f));
  EXPECT_EQ(sides.back, 300u * 200u) << "the eye is inside: nothing but back sides";

  stage.shot.ambient = {0, 0, 0};
  stage.shot.lights = {{{0, 1, 0}, {1, 1, 1}}};  // travels the way the camera looks, onto the wall before it
  stage.shot.material.back_color = {1, 1, 1};
  stage.shot.material.specular = 0;
  const render::Image lit = stage.draw(renderer(), 0.5f);
  EXPECT_GT(lit.row(100)[4 * 150], 245) << "head-on light on a white wall";
  stage.shot.lights[0].direction = {0, -1, 0};
  EXPECT_LT(stage.draw(renderer(), 0.5f).row(100)[4 * 150], 10)
      << "light from behind the wall does not reach its inside";
}

TEST_P(Picture, LightFallsOffWithTheCosine) {
  Stage stage(test::writeTestSphere("cosine.t4d", 2));
  stage.format = {401, 401, 1};
  const double t = 0, radius = test::kTestSphere.radiusAt(t);
  lookAlongY(stage.shot, toGlm(test::kTestSphere.centreAt(t)), 50);
  stage.shot.view.ortho_height = 2 * radius * 401 / 380;  // radius = 190 pixels
  stage.shot.ambient = {0, 0, 0};
  stage.shot.lights = {{{0, 1, 0}, {1, 1, 1}}};
  stage.shot.material.color = {1, 1, 1};
  stage.shot.material.specular = 0;
  const render::Image image = stage.draw(renderer(), static_cast<float>(t));
  for (const int offset : {0, 50, 100, 150}) {
    const double cosine = std::sqrt(1 - offset * offset / (190.0 * 190.0));
    const double srgb = 1.055 * std::pow(cosine, 1 / 2.4) - 0.055;
    EXPECT_NEAR(image.row(200)[4 * (200 + offset)], 255 * srgb, 3) << offset;
  }
}

TEST_P(Picture, HighlightStandsWhereTheMirrorSaysAndHasPhongsWidth) {
  Stage stage(test::writeTestSphere("highlight.t4d", 2));
  stage.format = {401, 401, 1};
  lookAlongY(stage.shot, toGlm(test::kTestSphere.centreAt(0)), 50);
  stage.shot.view.ortho_height = 2 * test::kTestSphere.radiusAt(0) * 401 / 380;
  stage.shot.ambient = {0, 0, 0};
  // The light comes from 60 degrees to the right: the mirror is at 30 degrees.
  const double sixty = glm::radians(60.0);
  stage.shot.lights = {{{-std::sin(sixty), std::cos(sixty), 0}, {1, 1, 1}}};
  stage.shot.material.color = {0, 0, 0};
  stage.shot.material.specular = 0.5;
  stage.shot.material.shininess = 20;
  const render::Image image = stage.draw(renderer(), 0);
  for (const int degrees : {20, 25, 30, 35, 40}) {
    const int x = static_cast<int>(std::lround(200 + 190 * std::sin(glm::radians(double(degrees)))));
    const double off = 2 * std::abs(std::asin((x - 200) / 190.0) - glm::radians(30.0));
    // Interpolated normals of this sphere are right to half a degree, which the mirror doubles.
    const auto srgbAt = [](double angle) {
      return 255 * (1.055 * std::pow(0.5 * std::pow(std::cos(std::max(angle, 0.0)), 20), 1 / 2.4) - 0.055);
    };
    const int seen = image.row(200)[4 * x];
    EXPECT_LE(seen, srgbAt(off - glm::radians(1.0)) + 1) << degrees;
    EXPECT_GE(seen, srgbAt(off + glm::radians(1.0)) - 1) << degrees;
  }
}

TEST_P(Picture, NearerSurfaceHidesTheOtherWhateverTheOrder) {
  const test::Surface ball = test::icosphere(2);
  const test::MovingSphere small{{0, -5, 0}, {0, 0, 0}, 1, 0}, large{{0, 0, 0}, {0, 0, 0}, 3, 0};
  const test::Page front = test::sweep(ball, small.motion(), 0, 1), back = test::sweep(ball, large.motion(), 0, 1);
  const test::FileSpec spec{{}, {0, 1}, paged::Codec::kRaw};
  Stage forward(test::writeFile("order_a.t4d", {front, back}, spec));
  Stage reverse(test::writeFile("order_b.t4d", {back, front}, spec));
  Stage alone(test::writeFile("order_c.t4d", {front}, spec));
  for (Stage* stage : {&forward, &reverse, &alone}) {
    lookAlongY(stage->shot, {0, 0, 0}, 20);
    stage->shot.lights = {{{1, 1, 0}, {1, 1, 1}}};
    stage->shot.background = {{0, 0, 0}, {0, 0, 0}, std::nullopt};
  }
  // Each file has its own renderer: page numbers name copies.
  auto second = host::makeOffscreenRenderer("cpu", 1, 1u << 30),
       third = host::makeOffscreenRenderer("cpu", 1, 1u << 30);
  const render::Image a = forward.draw(renderer(), 0.5f);
  const render::Image b = reverse.draw(*second.value(), 0.5f), c = alone.draw(*third.value(), 0.5f);
  EXPECT_LT(test::compare(a, b).rms, 2);
  std::uint64_t covered = 0, same = 0;
  for (std::size_t i = 0; i < c.rgba.size(); i += 4) {
    if (c.rgba[i] + c.rgba[i + 1] + c.rgba[i + 2] < 30) continue;
    ++covered;
    same += std::abs(int{a.rgba[i + 2]} - int{c.rgba[i + 2]}) <= 8 ? 1 : 0;
  }
  EXPECT_GT(covered, 400u);
  EXPECT_GT(static_cast<double>(same), 0.98 * static_cast<double>(covered)) << "the small sphere is seen whole";
}

TEST_P(Picture, FlatShadingIsConstantOnATriangle) {
  // One dynamic tetrahedron's slice between its second and third time is two triangles; an octahedron has eight faces.
  test::Surface octahedron;
  octahedron.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  octahedron.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const test::MovingSphere still{{0, 0, 0}, {0, 0, 0}, 2, 0};
  Stage stage(
      test::writeFile("flat.t4d", {test::sweep(octahedron, still.motion(), 0, 1)}, {{}, {0, 1}, paged::Codec::kRaw}));
  stage.smooth = false;
  stage.shot.view.eye = {8, -11, 9};
  stage.shot.view.target = {0, 0, 0};
  stage.shot.view.ortho_height = 5;
  stage.shot.material.specular = 0;
  stage.shot.background = {{0, 0, 0}, {0, 0, 0}, std::nullopt};
  const render::Image image = stage.draw(renderer(), 0.5f);
  std::map<std::uint32_t, int> pixels_of;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    ++pixels_of[std::uint32_t{image.rgba[i]} << 16 | std::uint32_t{image.rgba[i + 1]} << 8 | image.rgba[i + 2]];
  }
  int large = 0;
  for (const auto& [color, pixels] : pixels_of) large += pixels > 300 ? 1 : 0;
  EXPECT_EQ(large, 1 + 4) << "the background and four faces, each of one colour";
}

TEST_P(Picture, SampledPictureIsSmootherAndKeepsTheArea) {
  Stage stage(test::writeTestSphere("samples.t4d", 2));
  test::paintSides(stage.shot);
  const auto partial = [](const render::Image& image) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      count += image.rgba[i + 1] > 5 && image.rgba[i + 1] < 250 ? 1 : 0;
    return count;
  };
  EXPECT_EQ(partial(stage.draw(renderer(), 0.5f)), 0u);
  stage.format.samples = 4;
  EXPECT_GT(partial(stage.draw(renderer(), 0.5f)), 100u);
}

TEST_P(Picture, NearPlaneCutsTheSphereOpen) {
  Stage stage(test::writeTestSphere("near.t4d", 2));
  test::paintSides(stage.shot);
  lookAlongY(stage.shot, toGlm(test::kTestSphere.centreAt(0)), 50);
  stage.shot.view.ortho_height = 12;
  stage.shot.view.near_distance = 50;  // through the centre: the front half is gone
  const Sides sides = test::countSides(stage.draw(renderer(), 0));
  const double radius_px = 4.0 * 200 / 12, expected = std::numbers::pi * radius_px * radius_px;
  EXPECT_NEAR(static_cast<double>(sides.back), expected, 0.02 * expected);
  EXPECT_LE(sides.front, 2u);
}

TEST_P(Picture, EmptyListShowsTheBackground) {
  Stage stage(test::writeTestSphere("empty_list.t4d", 2));
  stage.shot.background = {{1, 1, 1}, {0, 0, 0}, std::nullopt};
  const render::Image image = stage.draw(renderer(), -1);
  EXPECT_NEAR(image.row(0)[0], 254, 1);
  EXPECT_NEAR(image.row(199)[0], 1, 1);
  EXPECT_NEAR(image.row(100)[4 * 299], 127, 2);
}

TEST_P(Picture, RoomShowsTheFarWallsOfTheBoxBehindEverything) {
  Stage stage(test::writeTestSphere("room.t4d", 2));
  test::paintSides(stage.shot);
  const Sides alone = test::countSides(stage.draw(renderer(), 0.5f));
  stage.shot.background.room = glm::dvec3(0, 0, 1);
  const scene::DrawList list = stage.list(0.5f);
  EXPECT_EQ(list.panels.size(), 3u) << "from outside, three walls of a box show their inner side";
  const render::Image image = stage.draw(renderer(), 0.5f);
  const Sides with_room = test::countSides(image);
  EXPECT_EQ(with_room.front, alone.front) << "walls hide nothing";
  std::uint64_t blue = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) blue += image.rgba[i + 2] > 127 ? 1 : 0;
  // Each line of sight that meets the box leaves it through one far wall, so walls and sphere fill its outline.
  double outline = 0;
  for (const scene::DrawPanel& panel : list.panels) {
    std::array<glm::dvec2, 4> p;
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::dvec4 clip = glm::dmat4(list.relative_to_clip) * glm::dvec4(glm::dvec3(panel.corners[k]), 1);
      p[k] = glm::dvec2(clip.x / clip.w * 150, clip.y / clip.w * 100);
    }
    double twice = 0;
    for (std::size_t k = 0; k < 4; ++k) twice += p[k].x * p[(k + 1) % 4].y - p[k].y * p[(k + 1) % 4].x;
    outline += std::abs(twice) / 2;
  }
  EXPECT_NEAR(static_cast<double>(blue + with_room.front), outline, 0.01 * outline);
}

TEST_P(Picture, UnusableFormatsAreFaults) {
  Stage stage(test::writeTestSphere("formats.t4d", 2));
  for (const scene::Format& format : {scene::Format{300, 200, 5}, scene::Format{0, 200, 1},
                                      scene::Format{20000, 200, 1}, scene::Format{9000, 10, 4}}) {
    scene::DrawList list = stage.list(0.5f);
    list.format = format;
    const auto image = renderer().draw(list, stage.sources());
    ASSERT_FALSE(image.ok());
    EXPECT_EQ(image.fault().code, FaultCode::kUsage);
    EXPECT_FALSE(image.fault().remedy.empty());
  }
}

TEST_P(Picture, GpuBudgetOfOneByteStillDraws) {
  Stage stage(test::writeTestSphere("small_budget.t4d", 4));
  test::paintSides(stage.shot);
  auto tight = host::makeOffscreenRenderer(GetParam(), 1, 1);
  ASSERT_TRUE(tight.ok());
  for (const float t : {0.5f, 1.5f, 0.5f, 2.5f}) {
    EXPECT_GT(test::countSides(stage.draw(*tight.value(), t)).front, 3000u) << t;
  }
}

// Slices themselves, by the CPU's slicer: area of the sphere, closed, nothing twice.
TEST(PageSlice, AreaOfTheSphereAtAnyTimeAndClosed) {
  Stage stage(test::writeTestSphere("slice.t4d", 4));
  render::PageSlicer slicer;
  for (const float t : {0.0f, 0.3f, 1.0f, 1.5f, 2.0f, 2.9f, 3.0f}) {
    double area = 0;
    std::size_t corners = 0, edges = 0;
    const scene::DrawList list = stage.list(t);
    for (const auto items : render::itemsByPage(list.surfaces[0].items)) {
      render::PageSlice slice;
      slicer.slice(*stage.source().resident(items.front().page), items, t, 3, slice);
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
      for (const auto& [a, b, c] : slice.triangles) {
        const auto p = [&](std::uint32_t i) {
          return glm::dvec3(slice.positions[i].x, slice.positions[i].y, slice.positions[i].z);
        };
        area += glm::length(glm::cross(p(b) - p(a), p(c) - p(a))) / 2;
        for (const auto& edge : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) ++uses[edge];
      }
      for (const auto& [edge, count] : uses) {
        EXPECT_EQ(count, 1) << "t = " << t;
        EXPECT_EQ((uses.count({edge.second, edge.first})), 1u) << "open edge at t = " << t;
      }
      corners += slice.positions.size();
      edges += uses.size() / 2;
      EXPECT_EQ(corners + slice.triangles.size(), edges + 2) << "a sphere, t = " << t;
    }
    const double radius = test::kTestSphere.radiusAt(t);
    EXPECT_NEAR(area, 4 * std::numbers::pi * radius * radius, 0.015 * area) << t;
  }
}

TEST(CpuRenderer, SamePictureForAnyNumberOfThreads) {
  Stage stage(test::writeTestSphere("threads.t4d", 2));
  const auto picture = [&](unsigned threads) {
    auto renderer = render::makeCpuRenderer(threads);
    return stage.draw(*renderer, 0.5f).rgba;
  };
  const auto one = picture(1);
  EXPECT_EQ(picture(2), one);
  EXPECT_EQ(picture(5), one);
}

}  // namespace
}  // namespace tet4d
