// Two-sided Phong lighting on the CPU: line by line what shaders/phong.frag.glsl does.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "player/scene/draw_list.h"
#include "player/scene/srgb.h"

namespace tet4d::render {

// position: relative to the box's centre; normal: interpolated, of any length; front: the triangle winds
// counter-clockwise. Returns sRGB, 0..1.
inline glm::vec3 shade(const scene::DrawList& list, const scene::DrawSurface& surface, const glm::vec3& position,
                       const glm::vec3& normal, bool front) {
  const glm::vec3 viewer = list.perspective ? glm::normalize(list.eye_or_backward - position) : list.eye_or_backward;
  const float length = glm::length(normal);
  // Where all triangles at a vertex are degenerate there is no normal: light it as if it faced the viewer.
  const glm::vec3 n = length > 0 ? (front ? normal : -normal) / length : viewer;
  const glm::vec3 base = front ? surface.front_color : surface.back_color;
  glm::vec3 color = list.ambient * base;
  for (const scene::DrawLight& light : list.lights) {
    const float diffuse = glm::dot(n, light.toward);
    if (diffuse <= 0) continue;
    const glm::vec3 mirrored = 2.0f * diffuse * n - light.toward;
    const float highlight = std::pow(std::max(glm::dot(mirrored, viewer), 0.0f), surface.shininess);
    color += light.color * (diffuse * base + surface.specular * highlight);
  }
  color = glm::clamp(color, 0.0f, 1.0f);
  return {scene::linearToSrgb(color.x), scene::linearToSrgb(color.y), scene::linearToSrgb(color.z)};
}

}  // namespace tet4d::render
