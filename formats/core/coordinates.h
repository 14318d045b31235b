// Index space to world and back: the one conversion both sides use.
//
// Vertices are f32 in index space (x, y, z in cells, t in frames); a file holds the f64 affine map and the f64 table of
// frame times, so neither a far origin nor epoch seconds cost a bit of the f32 coordinates.
#pragma once

#include <array>
#include <span>

#include "formats/core/vec.h"

namespace tet4d {

// world = origin + x * axes[0] + y * axes[1] + z * axes[2], all f64, world units.
struct AffineMap {
  std::array<double, 3> origin{0, 0, 0};
  std::array<std::array<double, 3>, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  friend bool operator==(const AffineMap&, const AffineMap&) = default;
};
static_assert(sizeof(AffineMap) == 96);

// Index coordinates (cells) to world units. Exact to one f64 rounding per operation.
std::array<double, 3> toWorld(const AffineMap& map, const std::array<double, 3>& index);

// Determinant of the axes: world volume of one cell, negative for a left-handed map.
double cellVolume(const AffineMap& map);

// True if every number is finite and the axes are not degenerate (|det| > 0).
bool isUsable(const AffineMap& map);

// Whether two maps are equal but for the last digits of decimal texts: to a millionth of a cell.
bool isSameGrid(const AffineMap& a, const AffineMap& b);

// World time of a frame number, piecewise linear between the table's entries, exact at them.
// times: strictly increasing, at least one; frame: clamped to [0, times.size() - 1].
double timeOfFrame(std::span<const double> times, double frame);

// Inverse of timeOfFrame; exact at the table's entries; time clamped to the table's range.
double frameOfTime(std::span<const double> times, double time);

// The f32 frame number a slice is taken at. A frame that lies within 1e-9 of an integer becomes that integer, so that
// a time printed and read back still hits the frame.
float sliceFrame(double frame);

}  // namespace tet4d
