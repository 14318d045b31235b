#include "player/scene/camera_control.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>

namespace tet4d::scene {
namespace {

constexpr double kNearest = 1e-4, kFarthest = 1e4;  // radii
constexpr double kMargin = 1.06;                    // of what is fitted

// The axes of the picture in the world: right, up and towards the viewer.
struct Axes {
  glm::dvec3 right, up, backward;
};

Axes axesOf(const View& view) {
  Axes axes{};
  axes.backward = glm::normalize(view.eye - view.target);
  glm::dvec3 right = glm::cross(glm::normalize(view.up), axes.backward);
  if (!(glm::length(right) > 1e-12)) {  // along the pole: any axis will do
    right = glm::cross(glm::abs(axes.backward.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), axes.backward);
  }
  axes.right = glm::normalize(right);
  axes.up = glm::cross(axes.backward, axes.right);
  return axes;
}

double tangent(const View& view) { return std::tan(glm::radians(view.fov_y_degrees) / 2); }

// Distance along the view of the plane things are moved in.
double depthOf(const View& view, const Axes& axes, const glm::dvec3& pivot) {
  const double to_target = glm::length(view.target - view.eye);
  const double depth = glm::dot(view.eye - pivot, axes.backward);
  return depth > 1e-6 * to_target ? depth : to_target;
}

// World units a pixel, in the plane at `depth`.
double unitsPerPixel(const View& view, const glm::dvec2& picture, double depth) {
  return (view.ortho_height ? *view.ortho_height : 2 * depth * tangent(view)) / picture.y;
}

// From the eye to the point under `pixel` at `depth`.
glm::dvec3 fromEye(const View& view, const Axes& axes, const glm::dvec2& picture, double depth,
                   const glm::dvec2& pixel) {
  const double unit = unitsPerPixel(view, picture, depth);
  const glm::dvec2 off = pixel - picture / 2.0;
  return axes.right * (off.x * unit) - axes.up * (off.y * unit) - axes.backward * depth;
}

View moved(const View& view, const glm::dvec3& by) {
  View out = view;
  out.eye += by;
  out.target += by;
  return out;
}

glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double degrees) {
  return glm::dvec3(glm::rotate(glm::dmat4(1), glm::radians(degrees), axis) * glm::dvec4(v, 0));
}

// Turns eye and target about the pivot as one body.
View rotatedAbout(const View& view, const glm::dvec3& pivot, const glm::dvec3& axis, double degrees) {
  View out = view;
  const glm::dvec3 eye = rotated(view.eye - pivot, axis, degrees);
  // The target by its difference from the eye, so that a far pivot costs the direction nothing.
  const glm::dvec3 sight = rotated(view.target - view.eye, axis, degrees);
  out.eye = pivot + eye;
  out.target = pivot + (eye + sight);
  return out;
}

glm::dvec3 directionTo(StandardView side) {
  switch (side) {
    case StandardView::kFront:
      return {0, -1, 0};
    case StandardView::kBack:
      return {0, 1, 0};
    case StandardView::kLeft:
      return {-1, 0, 0};
    case StandardView::kRight:
      return {1, 0, 0};
    case StandardView::kTop:
      return {0, -std::sin(glm::radians(kPoleDegrees)), std::cos(glm::radians(kPoleDegrees))};
    case StandardView::kBottom:
      return {0, -std::sin(glm::radians(kPoleDegrees)), -std::cos(glm::radians(kPoleDegrees))};
    case StandardView::kThreeQuarter:
      break;
  }
  return {0.50, -0.80, 0.36};  // as defaultShot()
}

}  // namespace

Projected project(const View& view, const glm::dvec2& picture, const glm::dvec3& world) {
  const Axes axes = axesOf(view);
  const glm::dvec3 off = world - view.eye;
  const double depth = -glm::dot(off, axes.backward);
  if (!view.ortho_height && !(depth > 0)) return {};
  const double unit = unitsPerPixel(view, picture, depth);
  return {picture / 2.0 + glm::dvec2(glm::dot(off, axes.right), -glm::dot(off, axes.up)) / unit, true};
}

glm::dvec3 pointUnder(const View& view, const glm::dvec2& picture, const glm::dvec3& pivot, const glm::dvec2& pixel) {
  const Axes axes = axesOf(view);
  return view.eye + fromEye(view, axes, picture, depthOf(view, axes, pivot), pixel);
}

View turn(const View& view, const glm::dvec3& pivot, double azimuth_degrees, double elevation_degrees) {
  const glm::dvec3 up = glm::normalize(view.up);
  View out = rotatedAbout(view, pivot, up, azimuth_degrees);
  const Axes axes = axesOf(out);
  const double from_pole = glm::degrees(std::acos(std::clamp(glm::dot(axes.backward, up), -1.0, 1.0)));
  // Positive elevation brings the eye up, towards the pole. A view that starts nearer to it only leaves it.
  const double low = std::min(kPoleDegrees, from_pole), high = std::max(180 - kPoleDegrees, from_pole);
  const double wanted = std::clamp(from_pole - elevation_degrees, low, high);
  return rotatedAbout(out, pivot, axes.right, wanted - from_pole);
}

View pan(const View& view, const glm::dvec2& picture, const glm::dvec3& pivot, const glm::dvec2& from,
         const glm::dvec2& to) {
  const Axes axes = axesOf(view);
  const double unit = unitsPerPixel(view, picture, depthOf(view, axes, pivot));
  const glm::dvec2 off = to - from;
  return moved(view, axes.up * (off.y * unit) - axes.right * (off.x * unit));
}

View zoom(const View& view, const glm::dvec2& picture, const WorldBox& box, const glm::dvec3& pivot,
          const glm::dvec2& pixel, double factor) {
  const Axes axes = axesOf(view);
  const double depth = depthOf(view, axes, pivot);
  const double radius = box.radius() > 0 ? box.radius() : 1;
  const double size = view.ortho_height ? *view.ortho_height : depth;
  // A view that is already outside the limits may come back in, and go no further out.
  const double low = std::min(kNearest * radius, size), high = std::max(kFarthest * radius, size);
  const double scale = std::clamp(size * factor, low, high) / size;
  const glm::dvec3 under = fromEye(view, axes, picture, depth, pixel);
  View out = view;
  if (view.ortho_height) {
    *out.ortho_height *= scale;
    const glm::dvec3 across = under - axes.backward * glm::dot(under, axes.backward);
    return moved(out, across * (1 - scale));
  }
  // Eye and target come nearer to the point in the same measure: it keeps its direction.
  const glm::dvec3 sight = view.target - view.eye;
  out.eye = view.eye + under * (1 - scale);
  out.target = out.eye + sight * scale;
  return out;
}

View fit(const View& view, const glm::dvec2& picture, const Frame& inner, const WorldBox& box) {
  const Axes axes = axesOf(view);
  const double width = std::max(inner.width, 1.0), height = std::max(inner.height, 1.0);
  View out = view;
  double distance = 0;
  if (view.ortho_height) {
    double units = 0;  // a pixel
    for (const glm::dvec3& corner : box.corners) {
      units = std::max({units, 2 * std::abs(glm::dot(corner, axes.right)) / width,
                        2 * std::abs(glm::dot(corner, axes.up)) / height});
    }
    out.ortho_height = units > 0 ? units * kMargin * picture.y : 1;
    distance = box.radius() > 0 ? 3 * box.radius() : 1;
  } else {
    const double across = tangent(view) * width / picture.y, along = tangent(view) * height / picture.y;
    for (const glm::dvec3& corner : box.corners) {
      distance =
          std::max(distance, glm::dot(corner, axes.backward) + std::max(std::abs(glm::dot(corner, axes.right)) / across,
                                                                        std::abs(glm::dot(corner, axes.up)) / along));
    }
    distance = distance > 0 ? distance * kMargin : 1;
  }
  out.target = box.centre;
  out.eye = box.centre + axes.backward * distance;
  return pan(out, picture, box.centre, picture / 2.0, inner.centre());
}

View standardView(StandardView side, const View& view, const glm::dvec2& picture, const Frame& inner,
                  const WorldBox& box) {
  View out = view;
  out.up = {0, 0, 1};
  out.target = box.centre;
  // Only the direction counts, at a distance that the centre's doubles resolve; fit() finds the right one.
  out.eye = box.centre + glm::normalize(directionTo(side)) * std::max(box.radius(), 1 + glm::length(box.centre));
  return fit(out, picture, inner, box);
}

View toggleProjection(const View& view, const glm::dvec3& pivot) {
  const Axes axes = axesOf(view);
  const double depth = depthOf(view, axes, pivot);
  View out = view;
  out.near_distance.reset();  // they mean something in one projection only
  out.far_distance.reset();
  if (!view.ortho_height) {
    out.ortho_height = 2 * depth * tangent(view);
    return out;
  }
  out.ortho_height.reset();
  // The plane of the pivot keeps its size if it lies at this distance.
  const double distance = *view.ortho_height / (2 * tangent(view));
  const glm::dvec3 sight = glm::normalize(view.target - view.eye);
  out.eye = view.eye - axes.backward * (depth - distance);
  out.target = out.eye + sight * distance;
  return out;
}

}  // namespace tet4d::scene
