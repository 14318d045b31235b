#include "player/scene/shot.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>

namespace tet4d::scene {
namespace {

const glm::dvec3 kTowardEye{0.50, -0.80, 0.36};  // from the target, not normalised
constexpr double kMargin = 1.06;                 // of the distance, so that nothing touches the frame

// Distance from the target (the box's centre) at which all corners are inside the picture.
double fittingDistance(const WorldBox& box, const View& view, double aspect) {
  const glm::dvec3 backward = glm::normalize(kTowardEye);
  const glm::dvec3 right = glm::normalize(glm::cross(view.up, backward));
  const glm::dvec3 upward = glm::cross(backward, right);
  const double tangent = std::tan(glm::radians(view.fov_y_degrees) / 2);
  double distance = 0;
  for (const glm::dvec3& corner : box.corners) {
    const double across = std::abs(glm::dot(corner, right)) / (tangent * aspect);
    const double along = std::abs(glm::dot(corner, upward)) / tangent;
    distance = std::max(distance, glm::dot(corner, backward) + std::max(across, along));
  }
  return distance > 0 ? distance * kMargin : 1;
}

}  // namespace

Shot defaultShot(const WorldBox& box, double aspect) {
  Shot shot;
  const double distance = fittingDistance(box, shot.view, aspect);
  shot.view.target = box.centre;
  shot.view.eye = box.centre + glm::normalize(kTowardEye) * distance;
  shot.lights = {
      {{0.75, 0.55, -1.0}, {0.80, 0.77, 0.71}},
      {{-1.0, 0.35, -0.25}, {0.16, 0.19, 0.24}},
      {{-0.1, -1.0, -0.45}, {0.20, 0.21, 0.23}},
  };
  return shot;
}

View orbit(const View& view, double degrees) {
  View turned = view;
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::normalize(view.up));
  turned.eye = view.target + glm::dvec3(turn * glm::dvec4(view.eye - view.target, 0));
  return turned;
}

}  // namespace tet4d::scene
