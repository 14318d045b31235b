// Moves a View by hand: turn, pan, zoom, fit, standard views. Pure arithmetic in double; no window, no GL.
//
// Everything happens about a pivot, a world point (usually the centre of the data). A point of the picture means the
// point of the scene under it in the plane through the pivot that faces the viewer. Pixels count from the upper left.
// Differences from the pivot are taken before anything is scaled, so data far from the world's origin turns as smoothly
// as data at the origin.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "player/scene/shot.h"
#include "player/scene/world_box.h"

namespace tet4d::scene {

// A rectangle of a picture, pixels.
struct Frame {
  double left = 0, top = 0, width = 1, height = 1;
  glm::dvec2 centre() const { return {left + width / 2, top + height / 2}; }
};

enum class StandardView { kThreeQuarter, kFront, kBack, kLeft, kRight, kTop, kBottom };

// How close to the pole, degrees between the line of sight and `up`, turn() and standardView() go: never over it.
inline constexpr double kPoleDegrees = 0.5;

// The picture's point of a world point, and whether it lies before the eye.
struct Projected {
  glm::dvec2 pixel{0};
  bool visible = false;
};
Projected project(const View& view, const glm::dvec2& picture, const glm::dvec3& world);

// The world point under `pixel` in the plane through the pivot. If the pivot is not before the eye, the plane through
// the target stands for it.
glm::dvec3 pointUnder(const View& view, const glm::dvec2& picture, const glm::dvec3& pivot, const glm::dvec2& pixel);

// A turntable: about `up` through the pivot by `azimuth`, then towards the pole by `elevation` (degrees). The pivot
// keeps its place in the picture. Stops kPoleDegrees before the poles.
View turn(const View& view, const glm::dvec3& pivot, double azimuth_degrees, double elevation_degrees);

// What was under `from` comes to lie under `to`.
View pan(const View& view, const glm::dvec2& picture, const glm::dvec3& pivot, const glm::dvec2& from,
         const glm::dvec2& to);

// Scales the distance (orthographic: the height) by `factor` > 0; what is under `pixel` stays there. The distance stays
// between 1e-4 and 1e4 radii of the data.
View zoom(const View& view, const glm::dvec2& picture, const WorldBox& box, const glm::dvec3& pivot,
          const glm::dvec2& pixel, double factor);

// Keeps the direction: the box's corners come to lie within `inner`, a rectangle of the picture, and its centre at the
// centre of it.
View fit(const View& view, const glm::dvec2& picture, const Frame& inner, const WorldBox& box);

// Looks at the box's centre from a side; the front is seen along +y, z is up. Then as fit().
View standardView(StandardView side, const View& view, const glm::dvec2& picture, const Frame& inner,
                  const WorldBox& box);

// Perspective to orthographic or back; what lies in the plane of the pivot keeps its size.
View toggleProjection(const View& view, const glm::dvec3& pivot);

}  // namespace tet4d::scene
