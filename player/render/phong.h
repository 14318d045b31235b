// Two-sided Phong lighting, colours by a column and refraction on the CPU: line by line what shaders/phong.frag.glsl
// does.
//
// Refraction (Ponchio & Hormann 2008, sec. 7.1, names it and no more). The viewing ray is bent once, where it meets the
// surface, and sees the background (gradient and room) some depth further on; the mirrored ray sees the gradient.
// How much is mirrored is Fresnel's formula for unpolarised light: unlike Schlick's it vanishes with an index of 1 and
// knows total reflection. What other surfaces lie behind is not seen.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "player/render/image.h"
#include "player/scene/draw_list.h"
#include "player/scene/srgb.h"

namespace tet4d::render {

// A visible point of a surface.
struct Fragment {
  glm::vec3 position;  // relative to the box's centre
  glm::vec3 normal;    // interpolated, of any length
  float value;         // of the column
  bool front;          // the triangle faces the viewer with its outside
  glm::vec2 pixel;     // its place in the picture, pixels, y up
};

inline glm::vec3 linearOf(const glm::vec3& srgb) {
  return {scene::srgbToLinear(srgb.x), scene::srgbToLinear(srgb.y), scene::srgbToLinear(srgb.z)};
}

// The background where the ray from the fragment along `ray` meets it; rows of `behind` run from the top. Linear.
inline glm::vec3 backgroundAlong(const scene::DrawList& list, const Image& behind, const Fragment& fragment,
                                 const glm::vec3& ray, float depth) {
  const glm::vec4 clip = list.relative_to_clip * glm::vec4(fragment.position + depth * ray, 1);
  const glm::vec2 size(static_cast<float>(behind.width), static_cast<float>(behind.height));
  const glm::vec2 at = clip.w > 0 ? (0.5f * glm::vec2(clip) / clip.w + 0.5f) * size : fragment.pixel;
  const glm::vec2 texel = glm::floor(glm::clamp(at, glm::vec2(0), size - 1.0f));
  const std::uint8_t* pixel = behind.row(behind.height - 1 - static_cast<std::uint32_t>(texel.y)) +
                              std::size_t{4} * static_cast<std::uint32_t>(texel.x);
  return {fromSrgb8(pixel[0]), fromSrgb8(pixel[1]), fromSrgb8(pixel[2])};
}

// What is seen through and in the surface; viewer, n: unit, on one side. Linear.
inline glm::vec3 transparent(const scene::DrawList& list, const scene::DrawSurface& surface, const Image& behind,
                             const Fragment& fragment, const glm::vec3& viewer, const glm::vec3& n,
                             const glm::vec3& base) {
  const float eta = fragment.front ? 1 / surface.refraction : surface.refraction;
  const float c = glm::clamp(glm::dot(n, viewer), 0.0f, 1.0f);
  const float below_root = 1 - eta * eta * (1 - c * c);
  const glm::vec3 mirrored = 2 * c * n - viewer;
  const glm::vec3 sky = linearOf(list.background_bottom + (0.5f + 0.5f * glm::dot(mirrored, list.up)) *
                                                              (list.background_top - list.background_bottom));
  if (below_root < 0) return sky;  // total reflection
  const float d = std::sqrt(below_root);
  const float along = (eta * c - d) / (eta * c + d), across = (c - eta * d) / (c + eta * d);
  const float reflected = c + d > 0 ? 0.5f * (along * along + across * across) : 1.0f;
  const glm::vec3 through = backgroundAlong(list, behind, fragment, -eta * viewer + (eta * c - d) * n,
                                            list.refraction_depth * surface.depth) *
                            (1.0f + surface.tint * (base - 1.0f));
  return through + reflected * (sky - through);
}

// `behind`: the picture before any surface; read if the surface refracts. Returns linear light, 0..1.
inline glm::vec3 shade(const scene::DrawList& list, const scene::DrawSurface& surface, const Fragment& fragment,
                       const Image& behind) {
  const glm::vec3 viewer =
      list.perspective ? glm::normalize(list.eye_or_backward - fragment.position) : list.eye_or_backward;
  const float length = glm::length(fragment.normal);
  // Where all triangles at a vertex are degenerate there is no normal: light it as if it faced the viewer.
  const glm::vec3 n = length > 0 ? (fragment.front ? fragment.normal : -fragment.normal) / length : viewer;
  const glm::vec3 base = surface.column   ? scene::colorOf(*surface.column, fragment.value)
                         : fragment.front ? surface.front_color
                                          : surface.back_color;
  const bool refracts = surface.refraction > 0;
  if (!surface.lit && !refracts) return glm::clamp(base, 0.0f, 1.0f);
  glm::vec3 color = refracts ? transparent(list, surface, behind, fragment, viewer, n, base) : list.ambient * base;
  // Below it the highlight is less than 1e-9 of the light: most samples need no power.
  const float least_highlight = std::exp2(-30 / surface.shininess);
  for (const scene::DrawLight& light : list.lights) {
    const float diffuse = glm::dot(n, light.toward);
    if (diffuse <= 0) continue;
    if (!refracts) color += light.color * (diffuse * base);
    const float cosine = glm::dot(2.0f * diffuse * n - light.toward, viewer);
    if (cosine > least_highlight) color += light.color * (surface.specular * std::pow(cosine, surface.shininess));
  }
  return glm::clamp(color, 0.0f, 1.0f);
}

}  // namespace tet4d::render
