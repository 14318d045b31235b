// The sRGB transfer function (IEC 61966-2-1), the same in shaders/phong.frag.glsl.
#pragma once

#include <cmath>

namespace tet4d::scene {

template <class Float>
Float srgbToLinear(Float c) {
  return c <= Float(0.04045) ? c / Float(12.92) : std::pow((c + Float(0.055)) / Float(1.055), Float(2.4));
}

template <class Float>
Float linearToSrgb(Float c) {
  return c <= Float(0.0031308) ? c * Float(12.92) : Float(1.055) * std::pow(c, Float(1 / 2.4)) - Float(0.055);
}

}  // namespace tet4d::scene
