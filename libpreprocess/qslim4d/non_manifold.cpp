#include "libpreprocess/qslim4d/non_manifold.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

namespace tet4d::qslim4d {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// The triangles opposite to a vertex, and what is asked of them.
class Link {
 public:
  void read(const SlimMesh& mesh, std::uint32_t v) {
    triangles_.clear();
    mesh.forEachTet(v, [&](std::uint32_t tet, std::uint32_t corner) {
      Triangle triangle{};
      std::size_t n = 0;
      for (std::uint32_t i = 0; i < 4; ++i)
        if (i != corner) triangle[n++] = mesh.tets[tet][i];
      std::sort(triangle.begin(), triangle.end());
      triangles_.push_back(triangle);
    });
    std::sort(triangles_.begin(), triangles_.end());
    edges_.clear();
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (const auto& [a, b] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
        edges_.push_back({triangles_[t][static_cast<std::size_t>(a)], triangles_[t][static_cast<std::size_t>(b)], t});
    }
    std::sort(edges_.begin(), edges_.end(),
              [](const Edge& a, const Edge& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  }

  // A sphere or a disc: every edge in one or two of the triangles, no triangle twice, all joined across edges, and
  // Euler characteristic 2, or 1 with a rim. A surface that is pinched in a vertex has one vertex less than the surface
  // it comes from, whose characteristic is at most 2, or 1: so there is no pinch if the figure is met.
  bool isSphereOrDisc() {
    if (std::adjacent_find(triangles_.begin(), triangles_.end()) != triangles_.end()) return false;
    roots_.resize(triangles_.size());
    std::iota(roots_.begin(), roots_.end(), 0U);
    std::int64_t edges = 0, pieces = static_cast<std::int64_t>(triangles_.size());
    bool has_rim = false;
    for (std::size_t i = 0, end = 0; i < edges_.size(); i = end) {
      while (end < edges_.size() && edges_[end].low == edges_[i].low && edges_[end].high == edges_[i].high) ++end;
      if (end - i > 2) return false;
      ++edges;
      if (end - i == 1) {
        has_rim = true;
        continue;
      }
      const std::uint32_t a = rootOf(edges_[i].triangle), b = rootOf(edges_[i + 1].triangle);
      if (a != b) roots_[a] = b, --pieces;
    }
    corners_.clear();
    for (const Triangle& triangle : triangles_) corners_.insert(corners_.end(), triangle.begin(), triangle.end());
    std::sort(corners_.begin(), corners_.end());
    const auto vertices = std::unique(corners_.begin(), corners_.end()) - corners_.begin();
    const std::int64_t euler = vertices - edges + static_cast<std::int64_t>(triangles_.size());
    return pieces == 1 && euler == (has_rim ? 1 : 2);
  }

  // Edges in more than two triangles whose ends have larger numbers than v: triangles of the mesh, each counted at its
  // least vertex.
  std::uint64_t crowdedAbove(std::uint32_t v) const {
    std::uint64_t count = 0;
    for (std::size_t i = 0, end = 0; i < edges_.size(); i = end) {
      while (end < edges_.size() && edges_[end].low == edges_[i].low && edges_[end].high == edges_[i].high) ++end;
      count += end - i > 2 && edges_[i].low > v ? 1 : 0;
    }
    return count;
  }

 private:
  struct Edge {
    std::uint32_t low, high, triangle;
  };
  std::uint32_t rootOf(std::uint32_t t) {
    while (roots_[t] != t) t = roots_[t] = roots_[roots_[t]];
    return t;
  }

  std::vector<Triangle> triangles_;  // ascending
  std::vector<Edge> edges_;          // ascending
  std::vector<std::uint32_t> roots_, corners_;
};

}  // namespace

NonManifold lockNonManifold(SlimMesh& mesh, bool first) {
  NonManifold found;
  Link link;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!mesh.isUsed(v) || (mesh.is_boundary[v] & kLocked) != 0) continue;
    link.read(mesh, v);
    if (link.isSphereOrDisc()) continue;
    mesh.is_boundary[v] |= kLocked | kPinned;
    if (!first && (mesh.is_boundary[v] & kUncounted) == 0) continue;
    ++found.vertices;
    found.triangles += link.crowdedAbove(v);
  }
  return found;
}

}  // namespace tet4d::qslim4d
