#include "player/scene/camera_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <random>

#include "player/scene/draw_list.h"

namespace tet4d::scene {
namespace {

const glm::dvec2 kPicture{1000, 600};
const Frame kInner{300, 0, 700, 500};

WorldBox boxAt(const glm::dvec3& origin, double side) {
  AffineMap map;
  map.origin = {origin.x, origin.y, origin.z};
  map.axes = {{{side / 10, 0, 0}, {0, side / 10, 0}, {0, 0, side / 10}}};
  return worldBox(map, {{0, 0, 0, 0}, {10, 10, 10, 1}});
}

// The pixel by way of the renderers' own matrix.
glm::dvec2 pixelOf(const WorldBox& box, const View& view, const glm::dvec3& world) {
  Shot shot;
  shot.view = view;
  const DrawList list = makeCamera(box, shot, {1000, 600, 1}, true);
  const glm::dvec4 clip = glm::dmat4(list.relative_to_clip) * glm::dvec4(world - box.centre, 1);
  return {(clip.x / clip.w + 1) * 500, (1 - clip.y / clip.w) * 300};
}

View someView(const WorldBox& box) { return fit(defaultShot(box, 1.6).view, kPicture, kInner, box); }

void expectNear(const glm::dvec2& a, const glm::dvec2& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
}

TEST(CameraControl, ProjectsAsTheRenderersDo) {
  const WorldBox box = boxAt({1, 2, 3}, 4);
  for (const bool ortho : {false, true}) {
    View view = someView(box);
    if (ortho) view = toggleProjection(view, box.centre);
    for (const glm::dvec3& corner : box.corners) {
      const Projected p = project(view, kPicture, box.centre + corner);
      ASSERT_TRUE(p.visible);
      expectNear(p.pixel, pixelOf(box, view, box.centre + corner), 0.01);
    }
  }
}

TEST(CameraControl, FitPutsAllCornersInsideTheFrameAndFillsIt) {
  const WorldBox box = boxAt({-3, 0, 9}, 0.5);
  View view = defaultShot(box, 1.6).view;
  for (const bool ortho : {false, true}) {
    if (ortho) view = toggleProjection(view, box.centre);
    const View fitted = fit(view, kPicture, kInner, box);
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
    for (const glm::dvec3& corner : box.corners) {
      const glm::dvec2 pixel = project(fitted, kPicture, box.centre + corner).pixel;
      left = std::min(left, pixel.x), right = std::max(right, pixel.x);
      top = std::min(top, pixel.y), bottom = std::max(bottom, pixel.y);
    }
    EXPECT_GE(left, 300);
    EXPECT_LE(right, 1000);
    EXPECT_GE(top, 0);
    EXPECT_LE(bottom, 500);
    EXPECT_GT(std::max((right - left) / 700, (bottom - top) / 500), 0.8);
    expectNear(project(fitted, kPicture, box.centre).pixel, kInner.centre(), 1e-6);
  }
}

TEST(CameraControl, PanKeepsThePointUnderTheCursor) {
  const WorldBox box = boxAt({0, 0, 0}, 10);
  for (const bool ortho : {false, true}) {
    View view = someView(box);
    if (ortho) view = toggleProjection(view, box.centre);
    const glm::dvec2 from{420, 130}, to{777, 431};
    const glm::dvec3 under = pointUnder(view, kPicture, box.centre, from);
    expectNear(project(view, kPicture, under).pixel, from, 1e-8);
    expectNear(project(pan(view, kPicture, box.centre, from, to), kPicture, under).pixel, to, 1e-8);
  }
}

TEST(CameraControl, ZoomKeepsThePointUnderTheCursor) {
  const WorldBox box = boxAt({0, 0, 0}, 10);
  for (const bool ortho : {false, true}) {
    View view = someView(box);
    if (ortho) view = toggleProjection(view, box.centre);
    const glm::dvec2 pixel{420, 130};
    const glm::dvec3 under = pointUnder(view, kPicture, box.centre, pixel);
    const View nearer = zoom(view, kPicture, box, box.centre, pixel, 0.25);
    expectNear(project(nearer, kPicture, under).pixel, pixel, 1e-7);
    const double before = glm::length(project(view, kPicture, box.centre).pixel - pixel);
    EXPECT_NEAR(glm::length(project(nearer, kPicture, box.centre).pixel - pixel), 4 * before, 1e-6 * before);
    // And back again.
    const View back = zoom(nearer, kPicture, box, box.centre, pixel, 4);
    EXPECT_NEAR(glm::length(back.eye - view.eye), 0, 1e-9);
  }
}

TEST(CameraControl, TurnKeepsThePivotsPlaceAndDistance) {
  const WorldBox box = boxAt({5, 5, 5}, 2);
  View view = someView(box);
  const glm::dvec2 place = project(view, kPicture, box.centre).pixel;
  const double distance = glm::length(view.eye - box.centre);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-40, 40);
  for (int i = 0; i < 1000; ++i) {
    view = turn(view, box.centre, angle(random), angle(random));
    ASSERT_NEAR(glm::length(view.eye - box.centre), distance, 1e-9 * distance * (i + 1));
  }
  expectNear(project(view, kPicture, box.centre).pixel, place, 1e-4);
}

TEST(CameraControl, ToggleKeepsThePlaneOfThePivot) {
  const WorldBox box = boxAt({5, 5, 5}, 2);
  const View view = someView(box);
  const View ortho = toggleProjection(view, box.centre);
  const View back = toggleProjection(ortho, box.centre);
  ASSERT_TRUE(ortho.ortho_height);
  ASSERT_FALSE(back.ortho_height);
  EXPECT_NEAR(glm::length(back.eye - view.eye), 0, 1e-9);
  const glm::dvec2 pixel{123, 456};
  const glm::dvec3 under = pointUnder(view, kPicture, box.centre, pixel);
  EXPECT_NEAR(project(ortho, kPicture, under).pixel.y - project(ortho, kPicture, box.centre).pixel.y,
              project(view, kPicture, under).pixel.y - project(view, kPicture, box.centre).pixel.y, 1e-6);
}

TEST(CameraControl, StandardViewsLookFromTheirSides) {
  const WorldBox box = boxAt({5, -5, 5}, 2);
  const View start = someView(box);
  const std::pair<StandardView, glm::dvec3> sides[] = {
      {StandardView::kFront, {0, -1, 0}}, {StandardView::kBack, {0, 1, 0}}, {StandardView::kLeft, {-1, 0, 0}},
      {StandardView::kRight, {1, 0, 0}},  {StandardView::kTop, {0, 0, 1}},  {StandardView::kBottom, {0, 0, -1}}};
  for (const auto& [side, direction] : sides) {
    const View view = standardView(side, start, kPicture, kInner, box);
    EXPECT_GT(glm::dot(glm::normalize(view.eye - view.target), direction), 0.9999);
    for (const glm::dvec3& corner : box.corners) {
      const glm::dvec2 pixel = project(view, kPicture, box.centre + corner).pixel;
      EXPECT_TRUE(pixel.x >= 300 && pixel.x <= 1000 && pixel.y >= 0 && pixel.y <= 500);
    }
  }
}

TEST(CameraControlStiff, ThePoleIsNeverPassed) {
  const WorldBox box = boxAt({0, 0, 0}, 2);
  for (const double step : {0.1, 7.0, 89.0, 400.0, -0.1, -7.0, -400.0}) {
    View view = someView(box);
    for (int i = 0; i < 2000; ++i) {
      view = turn(view, box.centre, 3, step);
      const double along = glm::dot(glm::normalize(view.eye - view.target), view.up);
      ASSERT_LT(std::abs(along), std::cos(0.9 * kPoleDegrees * 3.14159265 / 180)) << "step " << step << ", turn " << i;
    }
    // At the pole it still turns about the vertical, and comes back from it.
    const View back = turn(view, box.centre, 0, step > 0 ? -30 : 30);
    EXPECT_LT(std::abs(glm::dot(glm::normalize(back.eye - back.target), back.up)), 0.9);
  }
}

TEST(CameraControlStiff, FarFromTheOriginAndTinyOrHuge) {
  // The side over the distance from the origin goes down to 1e-8: a double keeps 1e-8 of the box then.
  for (const auto& [origin, side] : {std::pair{1e8, 1.0}, {4.5e6, 0.1}, {0.0, 1e-9}, {0.0, 1e9}, {1e-3, 1e-9}}) {
    const WorldBox box = boxAt({origin, -origin, origin / 2}, side);
    View view = someView(box);
    const glm::dvec2 pixel{640, 200};
    const glm::dvec3 under = pointUnder(view, kPicture, box.centre, pixel);
    view = zoom(view, kPicture, box, box.centre, pixel, 0.5);
    expectNear(project(view, kPicture, under).pixel, pixel, 0.01);
    view = pan(view, kPicture, box.centre, pixel, {300, 300});
    expectNear(project(view, kPicture, under).pixel, {300, 300}, 0.01);
    for (int i = 0; i < 100; ++i) view = turn(view, box.centre, 3.6, 0);
    expectNear(project(view, kPicture, under).pixel, {300, 300}, 0.1);
  }
}

TEST(CameraControlStiff, ZoomStopsAtItsLimits) {
  const WorldBox box = boxAt({0, 0, 0}, 2);
  for (const double factor : {0.1, 10.0}) {
    View view = someView(box);
    for (int i = 0; i < 100; ++i) view = zoom(view, kPicture, box, box.centre, kPicture / 2.0, factor);
    const double distance = glm::length(view.eye - view.target);
    EXPECT_TRUE(std::isfinite(distance) && distance > 0);
    EXPECT_LE(distance, 1.1e4 * box.radius());
  }
}

TEST(CameraControlStiff, EmptyAndFlatBoxesAndTinyPictures) {
  for (const Bounds4f& bounds :
       {Bounds4f{}, Bounds4f{{0, 0, 0, 0}, {5, 5, 0, 1}}, Bounds4f{{0, 0, 0, 0}, {0, 0, 7, 1}}}) {
    const WorldBox box = worldBox({}, bounds);
    for (const glm::dvec2& picture : {glm::dvec2(1, 1), glm::dvec2(16384, 1)}) {
      View view =
          standardView(StandardView::kTop, defaultShot(box, 1).view, picture, {0, 0, picture.x, picture.y}, box);
      view = toggleProjection(turn(view, box.centre, 10, -10), box.centre);
      view = zoom(fit(view, picture, {0, 0, picture.x, picture.y}, box), picture, box, box.centre, {0, 0}, 2);
      EXPECT_TRUE(std::isfinite(view.eye.x + view.eye.y + view.eye.z + view.target.x + *view.ortho_height));
      EXPECT_GT(glm::length(view.eye - view.target), 0);
    }
  }
}

}  // namespace
}  // namespace tet4d::scene
