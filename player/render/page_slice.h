// The slice of one page on the CPU: what the lookup shader does, with the same keys and the same formula.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "player/scene/draw_list.h"

namespace tet4d::render {

// Slice vertices are welded by key: the edge they cross, or, when t is exactly the time of an edge's end, that end.
struct PageSlice {
  std::vector<Vec3f> positions;                         // index space
  std::vector<Vec3f> areas;                             // sum of the cross products of the triangles at the vertex
  std::vector<std::uint32_t> keys;                      // of each vertex: its edge, or edges + end of the edge
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside; no two corners alike
};

// Slices pages; keeps its table of keys between calls: nothing is allocated or cleared for a slice.
class PageSlicer {
 public:
  // The triangles of the runs `items`, all of `page`, that are alive at t. with_areas: false leaves the areas zero.
  // O(triangles of the runs), memory O(edges + vertices).
  void slice(const dyntri::PageView& page, std::span<const scene::DrawItem> items, float t, float last_t,
             PageSlice& out, bool with_areas = true);

 private:
  void begin(const dyntri::PageView& page, PageSlice& out);
  std::uint32_t vertexOf(const dyntri::PageView& page, std::uint32_t edge, float t, PageSlice& out);
  void addTriangles(const dyntri::PageView& page, std::span<const std::uint32_t> triangles, std::uint64_t first,
                    float t, bool with_areas, PageSlice& out);

  // Keys: the edges, then the vertices. base_ + the slice's vertex; what is below base_ is left of earlier slices.
  std::vector<std::uint32_t> vertex_of_key_;
  std::uint32_t base_ = 1;
};

}  // namespace tet4d::render
