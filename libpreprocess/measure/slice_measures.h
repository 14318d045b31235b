// How large a slice is, and whether it is closed: area and enclosed volume of a triangle mesh, and the census of its
// edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "formats/core/coordinates.h"
#include "formats/core/vec.h"

namespace tet4d::measure {

struct SliceMeasures {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  // used by a triangle
  std::uint64_t edges = 0;
  std::uint64_t boundary_edges = 0;     // in one triangle
  std::uint64_t misoriented_edges = 0;  // in two triangles that run along it the same way
  std::uint64_t edges_over_two = 0;     // in three or more
  std::uint64_t unbalanced_edges = 0;   // along which not as many triangles run one way as the other
  double area = 0;                      // world units (the map's)
  // Enclosed volume by the divergence theorem with the field (x, y, z) / 3, positive if triangles are counter-clockwise
  // from outside. Meaningful if bounds().
  double volume = 0;
  // Whether it is the boundary of a volume: closed, but sheets of it may touch in edges or lie upon each other. Slices
  // exactly at the time of vertices do where what lies just beside that time has no thickness there.
  bool bounds() const { return unbalanced_edges == 0; }
  // As bounds(), and every edge in two triangles: no sheets touch.
  bool closed() const { return boundary_edges == 0 && misoriented_edges == 0 && edges_over_two == 0; }
  // vertices - edges + triangles: 2 for a sphere.
  std::int64_t euler() const {
    return static_cast<std::int64_t>(vertices) - static_cast<std::int64_t>(edges) +
           static_cast<std::int64_t>(triangles);
  }
};

// triangles: indices into positions (index space), all in range. map: to the units of area and volume; a left-handed
// map keeps the sign of the volume. Double, compensated sums. O(triangles log triangles).
SliceMeasures measureSlice(std::span<const Vec3f> positions, std::span<const std::array<std::uint32_t, 3>> triangles,
                           const AffineMap& map = {});

}  // namespace tet4d::measure
