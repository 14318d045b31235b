#include "player/scene/coloring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace tet4d::scene {

ColorRange rangeOf(const Coloring& coloring, const ColumnSpread* spread) {
  ColorRange range{coloring.low, coloring.high};
  if (coloring.range != RangeOf::kGiven && spread != nullptr) {
    const bool all = coloring.range == RangeOf::kAll;
    range = {all ? spread->least : spread->low, all ? spread->most : spread->high};
  }
  if (range.low > range.high) std::swap(range.low, range.high);
  // Factors begin above zero: at the least value that is.
  if (coloring.logarithmic && !(range.low > 0) && spread != nullptr && spread->least_above_zero > 0)
    range.low = std::min(spread->least_above_zero, range.high > 0 ? range.high : spread->least_above_zero);
  return range;
}

std::optional<DrawColumn> drawColumnOf(const Coloring& coloring, const dyntri::File& file, const ColumnSpread* spread) {
  if (coloring.by == ColorBy::kMaterial) return std::nullopt;
  if (coloring.by == ColorBy::kPart) return makePartColors();
  if (coloring.column >= file.columns().size() || (coloring.needsSpread() && spread == nullptr)) return std::nullopt;
  const ColorRange range = rangeOf(coloring, spread);
  DrawColumn made = makeDrawColumn(coloring.column, file.columns()[coloring.column].components, coloring.component,
                                   range.low, range.high, *coloring.map, {coloring.reversed, coloring.logarithmic});
  if (coloring.range != RangeOf::kGiven && spread->isOneValue()) {
    made.low = made.high = spread->middle();
    made.table.fill(colorOf(made, made.low));
    made.below = made.above = made.table.front();
  }
  return made;
}

void apply(const Coloring& coloring, const ColumnSpread* spread, SceneFile& file) {
  file.column = drawColumnOf(coloring, *file.file, spread);
  file.normal_column = coloring.normal_column;
  file.lit = coloring.lit;
}

int firstComponent(const dyntri::File& file, std::size_t column) {
  const std::uint32_t components = file.columns()[column].components;
  return components == 1 || (components == 3 && columnName(file, column) == "normal") ? 0 : kMagnitude;
}

std::string columnName(const dyntri::File& file, std::size_t column) {
  const ColumnEntry& entry = file.columns()[column];
  return {entry.name, strnlen(entry.name, sizeof entry.name)};
}

std::string valueName(const dyntri::File& file, std::size_t column, int component) {
  std::string name = columnName(file, column);
  const std::uint32_t components = file.columns()[column].components;
  if (components == 1) return name;
  if (component == kMagnitude) return name + ": length";
  constexpr const char* kAxes = "xyzw";
  return name + ": " + kAxes[component];
}

std::string partName(const dyntri::File& file, std::size_t part) {
  const auto parts = file.parts();
  if (part >= parts.size() || std::isnan(parts[part].isovalue)) return "part " + std::to_string(part);
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "isovalue %.6g", parts[part].isovalue);
  return text.data();
}

}  // namespace tet4d::scene
