// A ball that moves and grows, and what its hypersurface measures: closed forms, apart from everything they judge.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace tet4d::testing {

// Centre c + v t and radius r + g t, in cells and frames.
struct MovingBall {
  std::array<double, 3> centre, velocity;
  double radius, growth;

  std::array<double, 3> centreAt(double t) const {
    return {centre[0] + t * velocity[0], centre[1] + t * velocity[1], centre[2] + t * velocity[2]};
  }
  double radiusAt(double t) const { return radius + t * growth; }
  // Positive inside: distance to the surface.
  double fieldAt(double x, double y, double z, double t) const {
    const auto c = centreAt(t);
    return radiusAt(t) - std::hypot(x - c[0], y - c[1], z - c[2]);
  }

  double sliceArea(double t) const { return 4 * std::numbers::pi * radiusAt(t) * radiusAt(t); }
  double sliceVolume(double t) const { return sliceArea(t) * radiusAt(t) / 3; }

  // Integrals over 0 .. last of r^2 and r^3.
  double squares(double last) const { return power(3, last); }
  double cubes(double last) const { return power(4, last); }

  double volume4(double last) const { return 4 * std::numbers::pi / 3 * cubes(last); }
  double sweptArea(double last) const { return 4 * std::numbers::pi * squares(last); }
  // The hypersurface over the sphere's direction n moves at the normal speed w = v . n + g: its 3-volume is that of the
  // slices times sqrt(1 + w^2). With u = cos of the angle to v, the mean over the sphere is 1/2 the integral over u in
  // -1 .. 1, and F(w) = (w sqrt(1 + w^2) + asinh w) / 2 has F' = sqrt(1 + w^2).
  double volume3(double last) const {
    const double v = std::hypot(velocity[0], velocity[1], velocity[2]);
    const auto f = [](double w) { return (w * std::hypot(1.0, w) + std::asinh(w)) / 2; };
    const double mean = v > 0 ? (f(growth + v) - f(growth - v)) / (2 * v) : std::hypot(1.0, growth);
    return sweptArea(last) * mean;
  }

 private:
  // Integral of radiusAt^(n - 1).
  double power(int n, double last) const {
    if (growth == 0) return std::pow(radius, n - 1) * last;
    return (std::pow(radiusAt(last), n) - std::pow(radius, n)) / (n * growth);
  }
};

}  // namespace tet4d::testing
