#include "player/render/page_slice.h"

#include <limits>

#include "formats/core/tet_slice.h"

namespace tet4d::render {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

Vec3f crossProduct(const Vec3f& o, const Vec3f& p, const Vec3f& q) {
  const Vec3f u{p.x - o.x, p.y - o.y, p.z - o.z}, v{q.x - o.x, q.y - o.y, q.z - o.z};
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

}  // namespace

std::uint32_t PageSlicer::vertexOf(const dyntri::PageView& page, std::uint32_t edge, float t, PageSlice& out) {
  const auto [a, b] = page.edges[edge];
  std::size_t key = edge;
  if (t == page.vertices[b].t) {
    key = page.edges.size() + b;
  } else if (t == page.vertices[a].t) {
    key = page.edges.size() + a;
  }
  std::uint32_t& vertex = vertex_of_key_[key];
  if (vertex == kNone) {
    vertex = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(interpolateAt(page.vertices[a], page.vertices[b], t));
    out.areas.push_back({0, 0, 0});
    out.keys.push_back(static_cast<std::uint32_t>(key));
  }
  return vertex;
}

void PageSlicer::addTriangle(const dyntri::PageView& page, std::uint64_t triangle, float t, PageSlice& out) {
  std::array<std::uint32_t, 3> corners{};
  for (std::size_t k = 0; k < 3; ++k) corners[k] = vertexOf(page, page.triangles[triangle][k], t, out);
  if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
  out.triangles.push_back(corners);
  const Vec3f area = crossProduct(out.positions[corners[0]], out.positions[corners[1]], out.positions[corners[2]]);
  for (const std::uint32_t corner : corners) {
    Vec3f& sum = out.areas[corner];
    sum = {sum.x + area.x, sum.y + area.y, sum.z + area.z};
  }
}

void PageSlicer::slice(const dyntri::PageView& page, std::span<const scene::DrawItem> items, float t, float last_t,
                       PageSlice& out) {
  vertex_of_key_.assign(page.edges.size() + page.vertices.size(), kNone);
  out.positions.clear(), out.areas.clear(), out.keys.clear(), out.triangles.clear();
  for (const scene::DrawItem& item : items) {
    for (std::uint64_t i = item.first; i < item.first + item.count; ++i) {
      const dyntri::Lifespan& life = page.lifespans[i];
      if (isAlive(life.begin, life.end, t, last_t)) addTriangle(page, i, t, out);
    }
  }
}

}  // namespace tet4d::render
