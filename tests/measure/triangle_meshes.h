// Triangle meshes whose distances are known.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "libpreprocess/measure/triangle_tree.h"

namespace tet4d::testing {

struct Surface {
  std::vector<measure::Point3> points;
  std::vector<measure::Triangle> triangles;
  measure::SurfaceView view() const { return {points, triangles}; }
};

// The unit square at z, as two triangles.
inline Surface square(double z) { return {{{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}}, {{0, 1, 2}, {0, 2, 3}}}; }

// Every triangle in four.
inline Surface subdivided(const Surface& surface) {
  Surface fine{surface.points, {}};
  for (const measure::Triangle& t : surface.triangles) {
    std::array<std::uint32_t, 3> middle{};
    for (std::size_t c = 0; c < 3; ++c) {
      const measure::Point3 &a = surface.points[t[c]], &b = surface.points[t[(c + 1) % 3]];
      middle[c] = static_cast<std::uint32_t>(fine.points.size());
      fine.points.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
    }
    for (std::size_t c = 0; c < 3; ++c) fine.triangles.push_back({t[c], middle[c], middle[(c + 2) % 3]});
    fine.triangles.push_back({middle[0], middle[1], middle[2]});
  }
  return fine;
}

// Corners on the sphere, n rows of 2 n.
inline Surface sphere(const measure::Point3& centre, double radius, std::size_t n) {
  Surface surface;
  const std::size_t around = 2 * n;
  for (std::size_t i = 0; i <= n; ++i) {
    const double polar = std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    for (std::size_t j = 0; j < around; ++j) {
      const double turn = std::numbers::pi * static_cast<double>(j) / static_cast<double>(n);
      surface.points.push_back({centre[0] + radius * std::sin(polar) * std::cos(turn),
                                centre[1] + radius * std::sin(polar) * std::sin(turn),
                                centre[2] + radius * std::cos(polar)});
    }
  }
  const auto at = [&](std::size_t i, std::size_t j) { return static_cast<std::uint32_t>(i * around + j % around); };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < around; ++j) {
      if (i > 0) surface.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < n) surface.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  }
  return surface;
}

// Triangles at random, each tenth without area.
inline Surface soup(std::mt19937& random, std::size_t triangles) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Surface surface;
  for (std::size_t i = 0; i < triangles; ++i) {
    const measure::Point3 middle{unit(random), unit(random), unit(random)};
    const auto first = static_cast<std::uint32_t>(surface.points.size());
    for (std::size_t c = 0; c < 3; ++c) {
      surface.points.push_back(
          {middle[0] + 0.2 * unit(random), middle[1] + 0.2 * unit(random), middle[2] + 0.2 * unit(random)});
    }
    surface.triangles.push_back({first, first + 1, i % 10 == 0 ? first : first + 2});
  }
  return surface;
}

}  // namespace tet4d::testing
