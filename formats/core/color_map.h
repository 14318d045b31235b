// Colour maps by name: a value from 0 to 1 as a colour.
//
// A map is 33 knots in sRGB, evenly spaced, linear between them in the encoded values; within 6/255 of the published
// tables of 256, 2/255 on average. All but `grey` and `cool-warm` rise evenly in lightness and can be read by the
// colour-blind; `cool-warm` tells two sides of a middle apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace tet4d {

struct ColorMap {
  std::string_view name;
  std::string_view source;
  std::array<std::uint32_t, 33> knots;  // 0xRRGGBB, sRGB

  // The colour at s, clamped to 0..1 (NaN counts as 0): sRGB, each 0..1.
  std::array<float, 3> at(float s) const;
};

// All maps, the default one (viridis) first.
std::span<const ColorMap> colorMaps();

// The map called `name`, or null.
const ColorMap* findColorMap(std::string_view name);

}  // namespace tet4d
