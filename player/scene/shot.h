// A shot: where the camera stands, what lights the scene, what the surface is made of and what lies behind it.
//
// Positions and directions are in world units, f64. Colours that a user picks (material, background) are sRGB, 0..1;
// lights and ambient are linear factors, so that two lights add up.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "player/scene/world_box.h"

namespace tet4d::scene {

inline constexpr std::size_t kMaxLights = 8;

struct View {
  glm::dvec3 eye{0, -1, 0};
  glm::dvec3 target{0, 0, 0};
  glm::dvec3 up{0, 0, 1};
  double fov_y_degrees = 32;            // vertical opening angle, 0..180 exclusive; unused if ortho_height is given
  std::optional<double> ortho_height;   // height of an orthographic picture, world units
  std::optional<double> near_distance;  // from the eye along the view; without: just before the data
  std::optional<double> far_distance;   // without: just behind the data
};

struct Light {
  glm::dvec3 direction{0, 0, -1};  // the way the light travels; any length but zero
  glm::dvec3 color{1, 1, 1};       // linear, >= 0
};

struct Material {
  glm::dvec3 color{0.23, 0.54, 0.74};       // sRGB, of the side that faces out of the inside set
  glm::dvec3 back_color{0.27, 0.47, 0.60};  // sRGB, of the other side
  double specular = 0.25;                   // linear, >= 0
  double shininess = 48;                    // exponent of Phong's highlight, >= 1
  double refraction = 0;  // 0: opaque; 1..3: index of what lies inside, behind which the background shows
  double tint = 0;        // 0..1, with refraction: how much of what shows through takes the colour
  double depth = 0.5;     // 0..4, with refraction: of the background behind it, in radii of the scene's box
};

struct Background {
  glm::dvec3 top{0.97, 0.975, 0.98}, bottom{0.80, 0.83, 0.86};  // sRGB, a vertical gradient
  // sRGB: the far walls and the floor of the data's box, behind everything; without: nothing but the gradient.
  std::optional<glm::dvec3> room = glm::dvec3(0.88, 0.90, 0.915);
  unsigned checker = 0;  // squares along a wall of the room, about; 0: plain walls
};

struct Shot {
  View view;
  std::vector<Light> lights;          // at most kMaxLights
  glm::dvec3 ambient{0.2, 0.2, 0.2};  // linear, >= 0
  Material material;
  Background background;
};

// The camera if none is given: a three-quarter view from the front right and a little above, z up, the box's corners
// just inside a picture of `aspect` = width / height; a warm key light from the left, a cool fill, a rim light from
// behind.
Shot defaultShot(const WorldBox& box, double aspect);

// Turns the eye about the axis through the target along `up`, counter-clockwise seen from above.
View orbit(const View& view, double degrees);

}  // namespace tet4d::scene
