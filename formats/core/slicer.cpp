#include "formats/core/slicer.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace tet4d {
namespace {

// Slice vertices by key. Open addressing; numbers are given in order of first use, so the table's own order never
// shows.
class VertexWelder {
 public:
  explicit VertexWelder(SliceMesh& mesh) : mesh_(mesh), first_(mesh.keys.size()) { slots_.assign(64, kEmpty); }

  // The number of the vertex `key` in the mesh; appends it, where `position()` says, if it is new.
  template <class Position>
  std::uint32_t vertexOf(const SliceVertexKey& key, Position position) {
    std::size_t slot = slotOf(key);
    if (slots_[slot] != kEmpty) return slots_[slot];
    const auto number = static_cast<std::uint32_t>(mesh_.keys.size());
    mesh_.keys.push_back(key);
    mesh_.positions.push_back(position());
    slots_[slot] = number;
    if ((mesh_.keys.size() - first_) * 2 > slots_.size()) grow();
    return number;
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffu;

  static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }
  std::size_t slotOf(const SliceVertexKey& key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = static_cast<std::size_t>(mixed(mixed(key.a) + 0x9e3779b97f4a7c15ull * key.b)) & mask;
    while (slots_[slot] != kEmpty && mesh_.keys[slots_[slot]] != key) slot = (slot + 1) & mask;
    return slot;
  }
  void grow() {
    slots_.assign(slots_.size() * 2, kEmpty);
    for (std::size_t i = first_; i < mesh_.keys.size(); ++i)
      slots_[slotOf(mesh_.keys[i])] = static_cast<std::uint32_t>(i);
  }

  SliceMesh& mesh_;
  std::size_t first_;  // vertices of earlier calls are not welded with
  std::vector<std::uint32_t> slots_;
};

}  // namespace

void sliceTets(std::span<const std::array<std::uint32_t, 4>> tets, std::span<const Vec4f> positions,
               std::span<const std::uint64_t> ids, float t, float last_t, SliceMesh& mesh) {
  VertexWelder welder(mesh);
  for (const auto& tet : tets) {
    const TimeOrder order =
        orderByTime(positions[tet[0]].t, positions[tet[1]].t, positions[tet[2]].t, positions[tet[3]].t);
    std::array<std::uint32_t, 4> v;
    for (std::size_t k = 0; k < 4; ++k) v[k] = tet[order.at[k]];
    if (t < positions[v[0]].t || t > positions[v[3]].t) continue;

    // An edge's earlier end comes first, whatever the tetrahedron: an edge of constant time has no triangle alive.
    const auto keyOf = [&](std::uint8_t edge) {
      const std::uint32_t a = v[kTetEdges[edge][0]], b = v[kTetEdges[edge][1]];
      const std::uint64_t id_a = ids.empty() ? a : ids[a], id_b = ids.empty() ? b : ids[b];
      if (positions[a].t == t) return SliceVertexKey{id_a, id_a};
      if (positions[b].t == t) return SliceVertexKey{id_b, id_b};
      return SliceVertexKey{id_a, id_b};
    };
    for (const DynTriRule& rule : kDynTriRules) {
      if (!isAlive(positions[v[rule.begin]].t, positions[v[rule.end]].t, t, last_t)) continue;
      const std::array<SliceVertexKey, 3> keys{keyOf(rule.edges[0]), keyOf(rule.edges[1]), keyOf(rule.edges[2])};
      if (keys[0] == keys[1] || keys[1] == keys[2] || keys[2] == keys[0]) continue;
      std::array<std::uint32_t, 3> corners;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto& ends = kTetEdges[rule.edges[c]];
        corners[c] =
            welder.vertexOf(keys[c], [&] { return interpolateAt(positions[v[ends[0]]], positions[v[ends[1]]], t); });
      }
      if (order.odd) std::swap(corners[1], corners[2]);
      mesh.triangles.push_back(corners);
    }
  }
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
