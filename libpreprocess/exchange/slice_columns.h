// Values on the vertices of a slice: columns of a hypermesh interpolated where its edges are crossed, and the velocity
// of the surface taken from the tetrahedra themselves.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/slicer.h"
#include "formats/hypermesh.h"
#include "libpreprocess/column_list.h"

namespace tet4d::exchange {

struct MeshColumn {
  std::string name;
  unsigned components = 1;    // 1..4
  std::vector<float> values;  // components of vertex 0, of vertex 1, …
};

// Columns with a meaning of their own, both with three components in the world: unit and outward, zero where there is
// none; and world units a unit of world time, along the normal.
inline constexpr const char* kNormal = "normal";
inline constexpr const char* kVelocity = "velocity";

using tet4d::columnName;

// Appends the values of slice vertices to `column`. values: components floats for each of `positions`; ends: of the
// slice's vertices (TetSlicer::ends). The fraction is that of interpolateAt(): exact at both ends, computed from the
// earlier one, the rest in double. Three components called "normal" are made unit again, zero stays zero.
// O(vertices).
void interpolateColumn(std::span<const float> values, std::span<const Vec4f> positions,
                       std::span<const std::array<std::uint32_t, 2>> ends, float t, MeshColumn& column);

// The velocity of a slice along its normal. The surface swept by a tetrahedron has the 4D normal (n_s, n_t) in the
// world and moves with -n_t / |n_s|^2 n_s; a vertex has the mean over its triangles, weighted by their areas. Exact
// for a plane in uniform motion. World time runs, between two frames, as it does in the table of times; at a frame's
// time the step after it counts, at the last one the step before. Nearly flat tetrahedra (a birth, a death) are as
// fast as they are; what float32 cannot hold becomes its largest number. Zero where all triangles are degenerate.
class TetVelocity {
 public:
  // t: where the slice is, in frames.
  TetVelocity(const AffineMap& map, std::span<const double> times, float t);
  // Takes what the slicer's last add() of these tetrahedra appended. O(new triangles).
  void add(const TetSlicer& slicer, std::span<const hypermesh::Tet> tets, std::span<const Vec4f> positions);
  MeshColumn column(std::size_t vertices) const;

 private:
  std::array<double, 3> worldEdge(const std::array<double, 3>& index) const;
  std::array<double, 3> ofTet(const hypermesh::Tet& tet, std::span<const Vec4f> positions) const;

  std::array<std::array<double, 3>, 3> axes_;
  double time_of_frame_;                     // world time a frame lasts
  std::size_t triangles_ = 0;                // taken so far
  std::vector<std::array<double, 4>> sums_;  // by vertex: area * velocity, area
};

}  // namespace tet4d::exchange
