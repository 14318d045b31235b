#include "formats/core/slicer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tet4d {
namespace {

constexpr std::uint32_t kEmpty = 0xffffffffu;

std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

}  // namespace

// The slot of a key: its vertex's, or the empty one where it belongs.
inline std::size_t TetSlicer::slotOf(const SliceVertexKey& key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = static_cast<std::size_t>(mixed(key.a * 0x9e3779b97f4a7c15ull + key.b)) & mask;
  while (slots_[slot] != kEmpty && mesh_.keys[slots_[slot]] != key) slot = (slot + 1) & mask;
  return slot;
}

void TetSlicer::grow() {
  slots_.assign(std::max<std::size_t>(64, slots_.size() * 2), kEmpty);
  for (std::size_t i = 0; i < mesh_.keys.size(); ++i) slots_[slotOf(mesh_.keys[i])] = static_cast<std::uint32_t>(i);
}

void TetSlicer::add(std::span<const std::array<std::uint32_t, 4>> tets, std::span<const Vec4f> positions,
                    std::span<const std::uint64_t> ids) {
  if (slots_.empty()) grow();
  for (std::size_t i = 0; i < tets.size(); ++i) {
    const auto& tet = tets[i];
    const std::array<float, 4> times{positions[tet[0]].t, positions[tet[1]].t, positions[tet[2]].t,
                                     positions[tet[3]].t};
    // Most tetrahedra are not alive: they are told apart before any sorting.
    if (std::min(std::min(times[0], times[1]), std::min(times[2], times[3])) > t_ ||
        std::max(std::max(times[0], times[1]), std::max(times[2], times[3])) < t_) {
      continue;
    }
    const TimeOrder order = orderByTime(times[0], times[1], times[2], times[3]);
    std::array<std::uint32_t, 4> v;
    for (std::size_t k = 0; k < 4; ++k) v[k] = tet[order.at[k]];

    // An edge's earlier end comes first, whatever the tetrahedron: an edge of constant time has no triangle alive.
    const auto endsOf = [&](std::uint8_t edge) {
      const std::uint32_t a = v[kTetEdges[edge][0]], b = v[kTetEdges[edge][1]];
      if (positions[a].t == t_) return std::array{a, a};
      if (positions[b].t == t_) return std::array{b, b};
      return std::array{a, b};
    };
    const auto vertexOf = [&](const std::array<std::uint32_t, 2>& ends) {
      const SliceVertexKey key =
          ids.empty() ? SliceVertexKey{ends[0], ends[1]} : SliceVertexKey{ids[ends[0]], ids[ends[1]]};
      const std::size_t slot = slotOf(key);
      if (slots_[slot] != kEmpty) return slots_[slot];
      const auto number = static_cast<std::uint32_t>(mesh_.keys.size());
      slots_[slot] = number;
      mesh_.keys.push_back(key);
      mesh_.positions.push_back(interpolateAt(positions[ends[0]], positions[ends[1]], t_));
      ends_.push_back(ends);
      if (mesh_.keys.size() * 2 > slots_.size()) grow();
      return number;
    };
    std::array<std::uint32_t, 6> made;  // by edge: its vertex, once a triangle has used it
    made.fill(kEmpty);
    for (const DynTriRule& rule : kDynTriRules) {
      if (!isAlive(positions[v[rule.begin]].t, positions[v[rule.end]].t, t_, last_t_)) continue;
      const std::array ends{endsOf(rule.edges[0]), endsOf(rule.edges[1]), endsOf(rule.edges[2])};
      if (ends[0] == ends[1] || ends[1] == ends[2] || ends[2] == ends[0]) continue;
      std::array<std::uint32_t, 3> corners;
      for (std::size_t c = 0; c < 3; ++c) {
        std::uint32_t& vertex = made[rule.edges[c]];
        if (vertex == kEmpty) vertex = vertexOf(ends[c]);
        corners[c] = vertex;
      }
      if (order.odd) std::swap(corners[1], corners[2]);
      mesh_.triangles.push_back(corners);
      tets_.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

void sliceTets(std::span<const std::array<std::uint32_t, 4>> tets, std::span<const Vec4f> positions,
               std::span<const std::uint64_t> ids, float t, float last_t, SliceMesh& mesh) {
  TetSlicer slicer(t, last_t);
  slicer.add(tets, positions, ids);
  SliceMesh piece = slicer.take();
  if (mesh.keys.empty() && mesh.triangles.empty()) {
    mesh = std::move(piece);
    return;
  }
  const auto first = static_cast<std::uint32_t>(mesh.keys.size());
  mesh.keys.insert(mesh.keys.end(), piece.keys.begin(), piece.keys.end());
  mesh.positions.insert(mesh.positions.end(), piece.positions.begin(), piece.positions.end());
  for (const auto& [a, b, c] : piece.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

std::vector<Vec3f> sliceNormals(const SliceMesh& mesh) {
  std::vector<std::array<double, 3>> sums(mesh.positions.size(), {0, 0, 0});
  for (const auto& triangle : mesh.triangles) {
    const Vec3f &p = mesh.positions[triangle[0]], &q = mesh.positions[triangle[1]], &r = mesh.positions[triangle[2]];
    const std::array<double, 3> u{double{q.x} - p.x, double{q.y} - p.y, double{q.z} - p.z};
    const std::array<double, 3> w{double{r.x} - p.x, double{r.y} - p.y, double{r.z} - p.z};
    // The cross product's length is twice the area: the sum is area-weighted as it stands.
    const std::array<double, 3> n{u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
    for (const std::uint32_t corner : triangle) {
      for (std::size_t c = 0; c < 3; ++c) sums[corner][c] += n[c];
    }
  }
  std::vector<Vec3f> normals(sums.size(), Vec3f{0, 0, 0});
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double length = std::hypot(sums[i][0], sums[i][1], sums[i][2]);
    if (!(length > 0)) continue;
    normals[i] = {static_cast<float>(sums[i][0] / length), static_cast<float>(sums[i][1] / length),
                  static_cast<float>(sums[i][2] / length)};
  }
  return normals;
}

}  // namespace tet4d
