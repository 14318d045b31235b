#include "player/render/page_slice.h"

#include <algorithm>
#include <limits>

#include "formats/core/tet_slice.h"

namespace tet4d::render {
namespace {

// Triangles looked at in one go: those alive are found first, without branches, then sliced.
constexpr std::size_t kBlock = 1024;
// How many triangles ahead their keys and edges are fetched.
constexpr std::size_t kAhead = 12;

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
  std::uint32_t& known = vertex_of_key_[key];
  if (known >= base_) return known - base_;
  const auto vertex = static_cast<std::uint32_t>(out.positions.size());
  known = base_ + vertex;
  out.positions.push_back(interpolateAt(page.vertices[a], page.vertices[b], t));
  out.areas.push_back({0, 0, 0});
  out.keys.push_back(static_cast<std::uint32_t>(key));
  return vertex;
}

void PageSlicer::addTriangles(const dyntri::PageView& page, std::span<const std::uint32_t> triangles,
                              std::uint64_t first, float t, bool with_areas, PageSlice& out) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i + kAhead < triangles.size()) {
      for (const std::uint32_t edge : page.triangles[first + triangles[i + kAhead]]) {
        __builtin_prefetch(&vertex_of_key_[edge]);
        __builtin_prefetch(&page.edges[edge]);
      }
    }
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = vertexOf(page, page.triangles[first + triangles[i]][k], t, out);
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    out.triangles.push_back(corners);
    if (!with_areas) continue;
    const Vec3f area = crossProduct(out.positions[corners[0]], out.positions[corners[1]], out.positions[corners[2]]);
    for (const std::uint32_t corner : corners) {
      Vec3f& sum = out.areas[corner];
      sum = {sum.x + area.x, sum.y + area.y, sum.z + area.z};
    }
  }
}

// Makes room for the page's keys. Tables are cleared only when their numbers run out: once in 4 G slice vertices.
void PageSlicer::begin(const dyntri::PageView& page, PageSlice& out) {
  const std::size_t keys = page.edges.size() + page.vertices.size();
  if (vertex_of_key_.size() < keys) vertex_of_key_.resize(keys, 0);
  if (base_ > std::numeric_limits<std::uint32_t>::max() - std::min<std::size_t>(keys, 1U << 31)) {
    std::fill(vertex_of_key_.begin(), vertex_of_key_.end(), 0);
    base_ = 1;
  }
  out.positions.clear(), out.areas.clear(), out.keys.clear(), out.triangles.clear();
}

void PageSlicer::slice(const dyntri::PageView& page, std::span<const scene::DrawItem> items, float t, float last_t,
                       PageSlice& out, bool with_areas) {
  begin(page, out);
  std::array<std::uint32_t, kBlock> alive;
  for (const scene::DrawItem& item : items) {
    for (std::uint64_t done = 0; done < item.count; done += kBlock) {
      const std::uint64_t first = item.first + done;
      const auto lives = page.lifespans.subspan(first, std::min<std::uint64_t>(kBlock, item.count - done));
      std::size_t count = 0;
      for (std::uint32_t i = 0; i < lives.size(); ++i) {
        alive[count] = i;
        count += isAlive(lives[i].begin, lives[i].end, t, last_t) ? 1 : 0;
      }
      addTriangles(page, std::span(alive).first(count), first, t, with_areas, out);
    }
  }
  base_ += static_cast<std::uint32_t>(out.positions.size());
}

}  // namespace tet4d::render
