#include "player/scene/draw_column.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "player/scene/srgb.h"

namespace tet4d::scene {

DrawColumn makeDrawColumn(std::size_t column, std::uint32_t components, int component, float low, float high,
                          const ColorMap& map) {
  DrawColumn made;
  made.column = column;
  made.components = components;
  made.component = component;
  made.low = std::min(low, high);
  made.high = std::max(low, high);
  for (std::size_t i = 0; i < kMapEntries; ++i) {
    const auto srgb = map.at(static_cast<float>(i) / (kMapEntries - 1));
    made.table[i] = {srgbToLinear(srgb[0]), srgbToLinear(srgb[1]), srgbToLinear(srgb[2])};
  }
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
  const float span = 0.5f * column.high - 0.5f * column.low;
  const float s = span > 0 ? (0.5f * value - 0.5f * column.low) / span : 0.5f;
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
