// Whether slices of a mesh are closed: open edges away from the walls, at any times. For tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "formats/core/slicer.h"
#include "formats/hypermesh.h"
#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d::testing {

inline std::vector<hypermesh::Tet> liveTets(const SlimMesh& mesh) {
  std::vector<hypermesh::Tet> tets;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    if (mesh.isLive(t)) tets.push_back(mesh.tets[t]);
  return tets;
}

inline SliceMesh sliceOf(const SlimMesh& mesh, const Bounds4f& domain, float t) {
  SliceMesh slice;
  sliceTets(liveTets(mesh), mesh.positions, {}, t, domain.max.t, slice);
  return slice;
}

// Edges of a slice that are not in one triangle each way, unless both ends lie on one wall of space.
inline std::uint64_t openEdges(const SliceMesh& slice, const Bounds4f& domain) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& triangle : slice.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  const auto wallsOf = [&](const Vec3f& p) {
    const std::array<std::pair<float, float>, 6> sides{{{p.x, domain.min.x},
                                                        {p.x, domain.max.x},
                                                        {p.y, domain.min.y},
                                                        {p.y, domain.max.y},
                                                        {p.z, domain.min.z},
                                                        {p.z, domain.max.z}}};
    unsigned walls = 0;
    for (unsigned i = 0; i < 6; ++i) walls |= sides[i].first == sides[i].second ? 1U << i : 0;
    return walls;
  };
  std::uint64_t open = 0;
  for (const auto& [edge, sum] : balance)
    open += sum != 0 && (wallsOf(slice.positions[edge.first]) & wallsOf(slice.positions[edge.second])) == 0 ? 1 : 0;
  return open;
}

// Components of a slice, by common vertices.
inline std::size_t componentsOf(const SliceMesh& slice) {
  std::vector<std::uint32_t> root(slice.positions.size());
  for (std::uint32_t v = 0; v < root.size(); ++v) root[v] = v;
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b, c] : slice.triangles) root[find(a)] = find(b), root[find(b)] = find(c);
  std::vector<std::uint32_t> roots;
  for (const auto& triangle : slice.triangles) roots.push_back(find(triangle[0]));
  std::sort(roots.begin(), roots.end());
  return static_cast<std::size_t>(std::unique(roots.begin(), roots.end()) - roots.begin());
}

}  // namespace tet4d::qslim4d::testing
