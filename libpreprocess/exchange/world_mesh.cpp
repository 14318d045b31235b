#include "libpreprocess/exchange/world_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tet4d::exchange {
namespace {

std::array<double, 3> indexOf(const Vec3f& p) { return {p.x, p.y, p.z}; }

Vec3f asFloats(const std::array<double, 3>& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

}  // namespace

bool isLeftHanded(const AffineMap& map) { return cellVolume(map) < 0; }

bool needsDouble(const AffineMap& map, const Bounds4f& domain) {
  if (domain.empty()) return false;
  double farthest = 0, extent = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto world = toWorld(map, {double{(corner & 1) != 0 ? domain.max.x : domain.min.x},
                                     double{(corner & 2) != 0 ? domain.max.y : domain.min.y},
                                     double{(corner & 4) != 0 ? domain.max.z : domain.min.z}});
    for (std::size_t c = 0; c < 3; ++c) {
      farthest = std::max(farthest, std::abs(world[c]));
      extent = std::max(extent, std::abs(world[c] - map.origin[c]));
    }
  }
  return farthest > 4 * extent;
}

double floatError(const WorldMesh& mesh, const std::array<double, 3>& origin) {
  double most = 0;
  for (const auto& point : mesh.points) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double exact = point[c] - origin[c];
      most = std::max(most, std::abs(double{static_cast<float>(exact)} - exact));
    }
  }
  return most;
}

void takeNormals(WorldMesh& mesh, std::size_t column) {
  const std::vector<float>& values = mesh.columns[column].values;
  mesh.normals.clear();
  mesh.normals.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    mesh.normals.push_back({values[i], values[i + 1], values[i + 2]});
  }
  mesh.columns.erase(mesh.columns.begin() + static_cast<std::ptrdiff_t>(column));
}

WorldMesh worldMesh(const SliceMesh& slice, const AffineMap& map, bool with_normals) {
  WorldMesh mesh;
  mesh.triangles = slice.triangles;
  if (isLeftHanded(map)) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  mesh.points.reserve(slice.positions.size());
  for (const Vec3f& p : slice.positions) mesh.points.push_back(toWorld(map, indexOf(p)));
  if (!with_normals) return mesh;
  AffineMap around_origin = map;
  around_origin.origin = {0, 0, 0};
  SliceMesh relative;
  relative.triangles = mesh.triangles;
  for (const Vec3f& p : slice.positions) relative.positions.push_back(asFloats(toWorld(around_origin, indexOf(p))));
  mesh.normals = sliceNormals(relative);
  return mesh;
}

}  // namespace tet4d::exchange
