// Colours of a surface by a column of its file: a value at each vertex, interpolated along a slice's edge as positions
// are, then across the triangle, and looked up in a map for every sample. Ponchio & Hormann 2008, sec. 7.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "formats/core/color_map.h"

namespace tet4d::scene {

inline constexpr int kMagnitude = -1;
inline constexpr std::size_t kMapEntries = 256;

struct DrawColumn {
  std::size_t column = 0;                      // of the file's columns
  std::uint32_t components = 1;                // of the column, 1..4
  int component = 0;                           // 0 .. components - 1, or kMagnitude: the length
  float low = 0, high = 1;                     // low <= high: the values at the map's ends
  bool logarithmic = false;                    // 0 < low: equal steps of the map are equal factors
  bool of_parts = false;                       // no column is read: the value is partValue() of the page's part
  std::array<glm::vec3, kMapEntries> table{};  // linear light, from low to high
  glm::vec3 below{0}, above{1},
      unknown{0.25f, 0.25f, 0.25f};  // linear; unknown: NaN, or the page's column is not there
};

// Of one component or the magnitude of a column of `components`; below and above are the map's ends, unknown a grey.
// low > high are swapped. A logarithmic range is the caller's to keep above 0; otherwise it is drawn linear.
struct MapUse {
  bool reversed = false, logarithmic = false;
};
DrawColumn makeDrawColumn(std::size_t column, std::uint32_t components, int component, float low, float high,
                          const ColorMap& map, const MapUse& use = {});

// Colours by part, each of kPartColors its own; after them they start again.
inline constexpr std::size_t kPartColors = 12;
DrawColumn makePartColors();
inline float partValue(std::uint64_t part) { return static_cast<float>(part % kPartColors); }

// The number drawn for a row of the column: a component or the length.
float columnValue(const DrawColumn& column, std::span<const float> row);

// The colour of a value, linear; as shaders/phong.frag.glsl does it.
glm::vec3 colorOf(const DrawColumn& column, float value);

// Smallest and largest finite value of rows, all of a column's `components`, joined to what low and high hold.
void extendRange(std::span<const float> rows, const DrawColumn& column, float& low, float& high);

}  // namespace tet4d::scene
