// A slice in world coordinates, as mesh files want it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/slicer.h"
#include "formats/core/vec.h"
#include "libpreprocess/exchange/slice_columns.h"

namespace tet4d::exchange {

struct WorldMesh {
  std::vector<std::array<double, 3>> points;            // world units
  std::vector<Vec3f> normals;                           // unit, as many as points; empty if not asked for
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside, in the world too
  std::vector<MeshColumn> columns;                      // values of the points
};

// True if the map mirrors: triangles and tetrahedra must be turned over.
bool isLeftHanded(const AffineMap& map);

// True if float32 world coordinates would be coarser than the float32 index coordinates: the origin is farther away
// than four times the extent of `domain` (index space).
bool needsDouble(const AffineMap& map, const Bounds4f& domain);

// How far float32 numbers are from the points, at most, as they stand or from `origin`: world units. O(points).
double floatError(const WorldMesh& mesh, const std::array<double, 3>& origin = {0, 0, 0});

// A column of three components as the mesh's normals; the column is left out of the mesh's columns.
void takeNormals(WorldMesh& mesh, std::size_t column);

// O(slice). Normals are taken around the origin of the map, so a far origin costs them nothing.
WorldMesh worldMesh(const SliceMesh& slice, const AffineMap& map, bool with_normals);

}  // namespace tet4d::exchange
