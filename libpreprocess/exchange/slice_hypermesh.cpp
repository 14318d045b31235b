#include "libpreprocess/exchange/slice_hypermesh.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"

namespace tet4d::exchange {
namespace {

// Makes vertices with equal keys one, the one used first.
SliceMesh welded(const SliceMesh& mesh) {
  std::vector<std::uint32_t> by_key(mesh.keys.size());
  std::iota(by_key.begin(), by_key.end(), 0u);
  std::sort(by_key.begin(), by_key.end(),
            [&](std::uint32_t i, std::uint32_t j) { return std::pair(mesh.keys[i], i) < std::pair(mesh.keys[j], j); });
  std::vector<std::uint32_t> first(by_key.size());  // vertex → the first with its key
  for (std::size_t k = 0; k < by_key.size(); ++k) {
    const bool same = k > 0 && mesh.keys[by_key[k]] == mesh.keys[by_key[k - 1]];
    first[by_key[k]] = same ? first[by_key[k - 1]] : by_key[k];
  }
  SliceMesh result;
  std::vector<std::uint32_t> number(first.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    if (first[i] != i) {
      number[i] = number[first[i]];
      continue;
    }
    number[i] = static_cast<std::uint32_t>(result.keys.size());
    result.keys.push_back(mesh.keys[i]);
    result.positions.push_back(mesh.positions[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    result.triangles.push_back({number[triangle[0]], number[triangle[1]], number[triangle[2]]});
  }
  return result;
}

}  // namespace

SliceMesh sliceHypermesh(const hypermesh::File& mesh, double frame) {
  const float t = sliceFrame(frame), last_t = mesh.header().domain.max.t;
  SliceMesh slice;
  std::size_t pages = 0;
  for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
    const Bounds4f& bounds = mesh.geometryEntry(k).bounds;
    const bool alive = bounds.min.t <= t && (t < bounds.max.t || (t == bounds.max.t && t == last_t));
    if (!alive || mesh.geometryEntry(k).counts[2] == 0) continue;
    const hypermesh::GatheredPage page = unwrap(mesh.gather(k));
    sliceTets(page.view.tets, page.positions, globalNumbers(page.view), t, last_t, slice);
    ++pages;
  }
  return pages > 1 ? welded(slice) : slice;
}

}  // namespace tet4d::exchange
