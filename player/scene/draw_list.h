// What a renderer draws, and nothing else: numbers relative to the box's centre in float, and ranges of pages.
//
// The boundary between scene (which chooses) and render (which draws): both renderers take the same list and give the
// same picture. All lengths are world units, all colours linear except where said.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "player/scene/shot.h"
#include "player/scene/world_box.h"

namespace tet4d::scene {

// A picture's size, and how it is sampled.
struct Format {
  std::uint32_t width = 1280, height = 720;  // pixels, 1..16384
  std::uint32_t samples = 1;                 // per pixel: 1, 4, 9 or 16, on a square grid, box-filtered in linear light
};

struct DrawLight {
  glm::vec3 toward;  // unit vector from the surface to the light
  glm::vec3 color;
};

// A wall of the box seen from inside: a plane quadrilateral of one colour, unlit.
struct DrawPanel {
  std::array<glm::vec3, 4> corners;  // relative to the box's centre, around the quadrilateral
  glm::vec3 color;                   // sRGB
};

// A run of one page's triangles; all triangles alive at t that the page has lie within it.
struct DrawItem {
  std::size_t page;
  std::uint64_t first, count;
};

struct DrawList {
  Format format;
  bool smooth = true;  // normals by slice vertex; false: by triangle

  // relative = index_to_relative * (index - index_centre); an area vector a (cross product of two index-space edges)
  // has the direction normal_to_relative * a, which points out of the inside set even if the map is a mirror.
  glm::vec3 index_centre{0};
  glm::mat3 index_to_relative{1};
  glm::mat3 normal_to_relative{1};
  bool mirrored = false;          // the map is left-handed: counter-clockwise triangles turn clockwise
  glm::mat4 relative_to_clip{1};  // z in -w..w, y up
  // Perspective: the eye. Orthographic: the unit vector towards the viewer.
  bool perspective = true;
  glm::vec3 eye_or_backward{0, 0, 1};

  std::vector<DrawLight> lights;
  glm::vec3 ambient{0};
  glm::vec3 front_color{0}, back_color{0};
  float specular = 0, shininess = 1;
  glm::vec3 background_top{0}, background_bottom{0};  // sRGB: the gradient runs in the encoded values

  std::vector<DrawPanel> panels;  // behind everything, over the gradient; they do not overlap

  float t = 0, last_t = 0;  // frames
  std::vector<DrawItem> items;
  std::uint64_t processed = 0;  // triangles handed over
  std::uint64_t drawn = 0;      // of them alive at t
  std::uint64_t absent = 0;     // pages that should be drawn and are not resident
};

// Camera, lights and material as a renderer needs them; time and items are the chooser's. `shot` as proved by
// parseShot() or made by defaultShot().
DrawList makeDrawList(const WorldBox& box, const Shot& shot, const Format& format, bool smooth);

}  // namespace tet4d::scene
