#include "player/scene/draw_list.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "player/scene/srgb.h"

namespace tet4d::scene {
namespace {

struct DepthRange {
  double near, far;
};

// Just before and just behind the data, unless the view says otherwise.
DepthRange depthRange(const WorldBox& box, const View& view, const glm::dvec3& eye, const glm::dvec3& forward) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
  for (const glm::dvec3& corner : box.corners) {
    const double depth = glm::dot(corner - eye, forward);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  const double margin = 1e-3 * (box.radius() + glm::length(eye));
  DepthRange range{nearest - margin, farthest + margin};
  if (!view.ortho_height) {
    if (range.far <= 0) range.far = 1;  // all behind the eye: any range will do
    // A depth buffer resolves ratios, not differences: keep far / near bounded when the eye is inside the data.
    range.near = std::max(range.near, 1e-4 * range.far);
  }
  if (view.near_distance) range.near = *view.near_distance;
  if (view.far_distance) range.far = *view.far_distance;
  if (!(range.near < range.far)) {
    const double span = std::max(std::abs(range.near), 1e-6);
    if (view.far_distance) {
      range.near = view.ortho_height ? range.far - span : range.far / 2;
    } else {
      range.far = range.near + span;
    }
  }
  return range;
}

glm::dmat4 projection(const View& view, const DepthRange& depth, double aspect) {
  if (view.ortho_height) {
    const double half = *view.ortho_height / 2;
    return glm::ortho(-half * aspect, half * aspect, -half, half, depth.near, depth.far);
  }
  return glm::perspective(glm::radians(view.fov_y_degrees), aspect, depth.near, depth.far);
}

// Covariant map of area vectors. Only directions matter: scaled to 1, so that squares of tiny cells do not underflow.
glm::mat3 normalMap(const glm::dmat3& axes) {
  glm::dmat3 map = glm::transpose(glm::inverse(axes));
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(map[i][j]));
  }
  return glm::mat3(map / largest);
}

glm::vec3 linearOf(const glm::dvec3& srgb) {
  return {srgbToLinear(srgb.x), srgbToLinear(srgb.y), srgbToLinear(srgb.z)};
}

// The walls of the box whose inner side the viewer sees. Of a convex body these never hide one another.
std::vector<DrawPanel> panelsOf(const WorldBox& box, const Background& background, const DrawList& camera) {
  std::vector<DrawPanel> panels;
  const glm::dvec3 viewer(camera.eye_or_backward);
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
    for (const unsigned side : {0u, 1u << axis}) {
      const std::array<glm::dvec3, 4> corners{box.corners[side], box.corners[side | u], box.corners[side | u | v],
                                              box.corners[side | v]};
      glm::dvec3 outward = glm::cross(corners[1] - corners[0], corners[3] - corners[0]);
      if (glm::dot(outward, corners[0] + corners[2]) < 0) outward = -outward;
      const glm::dvec3 to_viewer = camera.perspective ? viewer - corners[0] : viewer;
      if (!(glm::dot(outward, to_viewer) < 0)) continue;  // seen from outside, or no area
      // A little shade tells floor and walls apart.
      const glm::dvec3 n = glm::abs(glm::normalize(outward));
      DrawPanel panel{{}, glm::vec3(*background.room * (1 - 0.05 * n.z - 0.025 * n.y)), glm::vec2(0)};
      std::copy(corners.begin(), corners.end(), panel.corners.begin());
      if (background.checker > 0) {
        // Squares of one size on all walls.
        const double square = 2 * box.radius() / std::sqrt(3.0) / static_cast<double>(background.checker);
        panel.squares = {std::ceil(glm::length(corners[1] - corners[0]) / square - 1e-6),
                         std::ceil(glm::length(corners[2] - corners[1]) / square - 1e-6)};
      }
      panels.push_back(panel);
    }
  }
  return panels;
}

}  // namespace

DrawList makeCamera(const WorldBox& box, const Shot& shot, const Format& format, bool smooth) {
  DrawList list;
  list.format = format;
  list.smooth = smooth;

  const glm::dvec3 eye = shot.view.eye - box.centre;
  const glm::dvec3 target = shot.view.target - box.centre;
  const glm::dvec3 forward = glm::normalize(target - eye);
  const double aspect = static_cast<double>(format.width) / format.height;
  const DepthRange depth = depthRange(box, shot.view, eye, forward);
  list.relative_to_clip =
      glm::mat4(projection(shot.view, depth, aspect) * glm::lookAt(eye, target, glm::normalize(shot.view.up)));
  list.perspective = !shot.view.ortho_height;
  list.eye_or_backward = glm::vec3(list.perspective ? eye : -forward);

  for (const Light& light : shot.lights) {
    list.lights.push_back({glm::vec3(-glm::normalize(light.direction)), glm::vec3(light.color)});
  }
  list.ambient = glm::vec3(shot.ambient);
  list.background_top = glm::vec3(shot.background.top);
  list.background_bottom = glm::vec3(shot.background.bottom);
  if (shot.background.room) list.panels = panelsOf(box, shot.background, list);
  list.up = glm::vec3(glm::normalize(shot.view.up));
  list.refraction_depth = static_cast<float>(box.radius());
  return list;
}

DrawSurface makeSurface(const WorldBox& own, const glm::dvec3& scene_centre, const Material& material) {
  DrawSurface surface;
  surface.index_centre = own.index_centre;
  surface.index_to_relative = glm::mat3(own.axes);
  surface.normal_to_relative = normalMap(own.axes);
  surface.offset = glm::vec3(own.centre - scene_centre);
  surface.mirrored = glm::determinant(own.axes) < 0;
  surface.front_color = linearOf(material.color);
  surface.back_color = linearOf(material.back_color);
  surface.specular = static_cast<float>(material.specular);
  surface.shininess = static_cast<float>(material.shininess);
  surface.refraction = static_cast<float>(material.refraction);
  surface.tint = static_cast<float>(material.tint);
  surface.depth = static_cast<float>(material.depth);
  return surface;
}

DrawList makeDrawList(const WorldBox& box, const Shot& shot, const Format& format, bool smooth) {
  DrawList list = makeCamera(box, shot, format, smooth);
  list.surfaces.push_back(makeSurface(box, box.centre, shot.material));
  return list;
}

}  // namespace tet4d::scene
