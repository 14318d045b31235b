// What a renderer draws, and nothing else: numbers relative to the box's centre in float, and ranges of pages.
//
// The boundary between scene (which chooses) and render (which draws): both renderers take the same list and give the
// same picture. All lengths are world units, all colours linear except where said.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "player/scene/draw_column.h"
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
  glm::vec2 squares{0};              // of a checker along the sides 0-1 and 1-2; 0: one colour
};
// The darker squares of a checker.
inline constexpr float kCheckerShade = 0.8f;

// A run of one page's triangles. Items of one page stand together; all triangles alive at t that the page has lie
// within them.
struct DrawItem {
  std::size_t page;
  std::uint64_t first, count;
};

// One file's part of a picture.
struct DrawSurface {
  std::size_t source = 0;  // of those given to the renderer
  // relative = index_to_relative * (index - index_centre) + offset; an area vector a (cross product of two index-space
  // edges) has the direction normal_to_relative * a, which points out of the inside set even if the map is a mirror.
  glm::vec3 index_centre{0};
  glm::mat3 index_to_relative{1};
  glm::mat3 normal_to_relative{1};
  glm::vec3 offset{0};    // of the file's centre from the scene's; 0 for a scene of one file
  bool mirrored = false;  // the map is left-handed: counter-clockwise triangles turn clockwise

  glm::vec3 front_color{0}, back_color{0};
  float specular = 0, shininess = 1;
  // 0: opaque; 1 to 3: the index of what lies inside, see Material. `tint`: how much of the light takes the colour.
  float refraction = 0, tint = 0;
  float depth = 1;  // times the list's refraction_depth
  bool lit = true;  // false: the colour as it is, without light and highlight; without effect on what refracts
  std::optional<DrawColumn> column;          // colours by a column or part, both sides alike, in place of the two
  std::optional<std::size_t> normal_column;  // three components, unit, world; without: normals of the slice

  float t = 0, last_t = 0;  // frames
  std::vector<DrawItem> items;
  std::uint64_t processed = 0;  // triangles handed over
  std::uint64_t drawn = 0;      // of them alive at t
  std::uint64_t absent = 0;     // pages that should be drawn and are not resident
};

struct DrawList {
  Format format;
  bool smooth = true;             // normals by slice vertex; false: by triangle
  glm::mat4 relative_to_clip{1};  // z in -w..w, y up
  // Perspective: the eye. Orthographic: the unit vector towards the viewer.
  bool perspective = true;
  glm::vec3 eye_or_backward{0, 0, 1};

  std::vector<DrawLight> lights;
  glm::vec3 ambient{0};
  glm::vec3 background_top{0}, background_bottom{0};  // sRGB: the gradient runs in the encoded values
  std::vector<DrawPanel> panels;                      // behind everything, over the gradient; they do not overlap
  glm::vec3 up{0, 0, 1};                              // unit: where background_top is, for what a surface mirrors
  float refraction_depth = 1;  // world units that a refracted ray goes to meet the background, before depth
  std::vector<DrawSurface> surfaces;

  // Sums over the surfaces.
  std::uint64_t processed() const { return sum(&DrawSurface::processed); }
  std::uint64_t drawn() const { return sum(&DrawSurface::drawn); }
  std::uint64_t absent() const { return sum(&DrawSurface::absent); }
  bool refracts() const {
    return std::any_of(surfaces.begin(), surfaces.end(), [](const DrawSurface& s) { return s.refraction > 0; });
  }

 private:
  std::uint64_t sum(std::uint64_t DrawSurface::*count) const {
    std::uint64_t total = 0;
    for (const DrawSurface& surface : surfaces) total += surface.*count;
    return total;
  }
};

// Camera and lights as a renderer needs them, relative to the box's centre; no surfaces. `shot` as proved by
// parseShot() or made by defaultShot().
DrawList makeCamera(const WorldBox& box, const Shot& shot, const Format& format, bool smooth);

// A surface of `material` in the box of its file, relative to `scene_centre` (world units). Time and items are the
// chooser's.
DrawSurface makeSurface(const WorldBox& own, const glm::dvec3& scene_centre, const Material& material);

// A scene of one file: camera and its surface.
DrawList makeDrawList(const WorldBox& box, const Shot& shot, const Format& format, bool smooth);

}  // namespace tet4d::scene
