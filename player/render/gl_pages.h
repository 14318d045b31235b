// Copies of pages in the driver's memory within a byte budget: vertices as a buffer texture, edges as a vertex buffer,
// triangles as an index buffer. Private to player/render.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "formats/dynamic_triangles.h"
#include "player/render/gl_objects.h"

namespace tet4d::render {

struct GlPage {
  GlTable vertices;
  GlBuffer edges, triangles;
  GlVertexArray arrays;                    // draws edges (attribute 0) by triangles
  std::map<std::size_t, GlTable> columns;  // those drawn so far
  std::size_t number = 0;
  std::uint64_t bytes = 0;
  std::uint64_t last_frame = 0;
  GLint edge_count = 0;
  GLint key_count = 0;  // edges + vertices

  // Binds the vertices to their unit, and the arrays.
  void bind() const;
};

class GlPages {
 public:
  explicit GlPages(std::uint64_t budget_bytes) : budget_bytes_(budget_bytes) {}
  // Copies of earlier frames beyond the budget go now, so that the new frame's come on top of no more than that.
  void beginFrame() {
    ++frame_;
    evict();
  }
  // The copy of page `number` of a source, made from `page` if there is none. Fault if a table exceeds the driver's
  // limit.
  Result<GlPage*> get(std::size_t source, std::size_t number, const dyntri::PageView& page);
  // Binds the copy of a column of `page` to a unit, made from `rows` if there is none.
  Status bindColumn(GlPage& page, std::size_t column, std::span<const float> rows, int unit);
  // Drops the copies used longest ago, none of this frame, until the budget holds.
  void evict();
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t budget_bytes_, bytes_ = 0, frame_ = 0;
  std::map<std::pair<std::size_t, std::size_t>, GlPage> pages_;  // by source and number
};

}  // namespace tet4d::render
