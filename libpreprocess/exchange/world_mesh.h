// A slice in world coordinates, as mesh files want it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/slicer.h"
#include "formats/core/vec.h"

namespace tet4d::exchange {

struct WorldMesh {
  std::vector<std::array<double, 3>> points;            // world units
  std::vector<Vec3f> normals;                           // unit, as many as points; empty if not asked for
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside, in the world too
};

// True if the map mirrors: triangles and tetrahedra must be turned over.
bool isLeftHanded(const AffineMap& map);

// True if float32 world coordinates would be coarser than the float32 index coordinates: the origin is farther away
// than four times the extent of `domain` (index space).
bool needsDouble(const AffineMap& map, const Bounds4f& domain);

// O(slice). Normals are taken around the origin of the map, so a far origin costs them nothing.
WorldMesh worldMesh(const SliceMesh& slice, const AffineMap& map, bool with_normals);

}  // namespace tet4d::exchange
