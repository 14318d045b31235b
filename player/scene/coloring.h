// How a file is coloured, as a user chooses it; and what that is in a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "formats/core/color_map.h"
#include "player/scene/column_spread.h"
#include "player/scene/draw_column.h"
#include "player/scene/scene_files.h"

namespace tet4d::scene {

enum class ColorBy : std::uint8_t { kMaterial, kPart, kColumn };
// What the map is stretched over: 98 % of the values, all of them, or what is given.
enum class RangeOf : std::uint8_t { kMost, kAll, kGiven };

struct Coloring {
  ColorBy by = ColorBy::kMaterial;
  std::size_t column = 0;  // of the file
  int component = 0;       // or kMagnitude
  RangeOf range = RangeOf::kMost;
  float low = 0, high = 1;  // kGiven
  const ColorMap* map = &colorMaps()[0];
  bool reversed = false;
  bool logarithmic = false;  // what lies at or below zero takes the lowest colour
  bool lit = true;
  std::optional<std::size_t> normal_column;

  bool needsSpread() const { return by == ColorBy::kColumn && (range != RangeOf::kGiven || logarithmic); }
};

// The ends of the map. `spread` may be null if the coloring does not need it.
struct ColorRange {
  float low = 0, high = 1;
};
ColorRange rangeOf(const Coloring& coloring, const ColumnSpread* spread);

// Colours of `file` by column or part; nothing by material, or where the column's spread is needed and not known yet
// (null). A file without parts is one part. Values that are one value but for rounding are one colour.
std::optional<DrawColumn> drawColumnOf(const Coloring& coloring, const dyntri::File& file, const ColumnSpread* spread);

// Sets what a SceneFile holds of it.
void apply(const Coloring& coloring, const ColumnSpread* spread, SceneFile& file);

// What of a column is looked at first: its one number, of a vector the length; of normals, whose length says nothing,
// the first component.
int firstComponent(const dyntri::File& file, std::size_t column);

std::string columnName(const dyntri::File& file, std::size_t column);
// "velocity: length", "velocity: y", "pressure": the name with what is drawn of it.
std::string valueName(const dyntri::File& file, std::size_t column, int component);
// "isovalue 0.5", or "part 2" if it has none.
std::string partName(const dyntri::File& file, std::size_t part);

}  // namespace tet4d::scene
