#include "player/scene/draw_column.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "player/scene/srgb.h"

namespace tet4d::scene {

namespace {

// Told apart also by the colour-blind as far as twelve can be: neighbours differ in lightness. sRGB.
constexpr std::array<std::uint32_t, kPartColors> kParts{0x3a7fb8, 0xe9a13b, 0x3f9a63, 0xc9504a, 0x8d6cc0, 0xd9cf57,
                                                        0x5cc4c9, 0x8a5a3c, 0xe08fb4, 0x5d6670, 0xa9c76a, 0x2f4a8a};

glm::vec3 linearOf(std::uint32_t srgb) {
  const auto channel = [&](unsigned shift) {
    return srgbToLinear(static_cast<float>((srgb >> shift) & 0xff) / 255.0f);
  };
  return {channel(16), channel(8), channel(0)};
}

}  // namespace

DrawColumn makeDrawColumn(std::size_t column, std::uint32_t components, int component, float low, float high,
                          const ColorMap& map, const MapUse& use) {
  DrawColumn made;
  made.column = column;
  made.components = components;
  made.component = component;
  made.low = std::min(low, high);
  made.high = std::max(low, high);
  made.logarithmic = use.logarithmic && made.low > 0;
  for (std::size_t i = 0; i < kMapEntries; ++i) {
    const auto srgb = map.at(static_cast<float>(use.reversed ? kMapEntries - 1 - i : i) / (kMapEntries - 1));
    made.table[i] = {srgbToLinear(srgb[0]), srgbToLinear(srgb[1]), srgbToLinear(srgb[2])};
  }
  made.below = made.table.front();
  made.above = made.table.back();
  return made;
}

DrawColumn makePartColors() {
  DrawColumn made;
  made.of_parts = true;
  made.high = static_cast<float>(kMapEntries - 1);  // value n is entry n
  for (std::size_t i = 0; i < kMapEntries; ++i) made.table[i] = linearOf(kParts[i % kPartColors]);
  made.below = made.table.front();
  made.above = made.table.back();
  return made;
}

float columnValue(const DrawColumn& column, std::span<const float> row) {
  if (column.component != kMagnitude) return row[static_cast<std::size_t>(column.component)];
  float squares = 0;
  for (const float x : row) squares += x * x;
  return std::sqrt(squares);
}

glm::vec3 colorOf(const DrawColumn& column, float value) {
  if (std::isnan(value)) return column.unknown;
  if (value < column.low) return column.below;
  if (value > column.high) return column.above;
  // By halves: the difference of two floats may exceed the largest one.
  float low = 0.5f * column.low, high = 0.5f * column.high, at = 0.5f * value;
  if (column.logarithmic) low = std::log2(column.low), high = std::log2(column.high), at = std::log2(value);
  const float span = high - low;
  const float s = span > 0 ? (at - low) / span : 0.5f;
  const float position = glm::clamp(s, 0.0f, 1.0f) * (kMapEntries - 1);
  const auto entry = std::min(static_cast<std::size_t>(position), kMapEntries - 2);
  return column.table[entry] + (position - static_cast<float>(entry)) * (column.table[entry + 1] - column.table[entry]);
}

void extendRange(std::span<const float> rows, const DrawColumn& column, float& low, float& high) {
  for (std::size_t i = 0; i + column.components <= rows.size(); i += column.components) {
    const float value = columnValue(column, rows.subspan(i, column.components));
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
}

}  // namespace tet4d::scene
