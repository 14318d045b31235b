#include "player/render/gl_pages.h"

#include <algorithm>
#include <span>
#include <string>

#include "player/render/gl_units.h"

namespace tet4d::render {
namespace {

GlBuffer makeBuffer(GLenum target, std::span<const std::byte> bytes) {
  GlBuffer buffer = GlBuffer::create();
  glBindBuffer(target, buffer.get());
  glBufferData(target, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STATIC_DRAW);
  return buffer;
}

}  // namespace

void GlPage::bind() const {
  vertices.bind(kVerticesUnit);
  glBindVertexArray(arrays.get());
}

Result<GlPage*> GlPages::get(std::size_t source, std::size_t number, const dyntri::PageView& page) {
  if (const auto found = pages_.find({source, number}); found != pages_.end()) {
    found->second.last_frame = frame_;
    return &found->second;
  }
  auto vertices = makeTable(GL_RGBA32F, std::as_bytes(page.vertices), sizeof(Vec4f), kVerticesUnit,
                            "page " + std::to_string(number));
  if (!vertices.ok()) return vertices.fault();
  GlPage copy;
  copy.vertices = std::move(vertices).value();
  copy.arrays = GlVertexArray::create();
  glBindVertexArray(copy.arrays.get());
  copy.edges = makeBuffer(GL_ARRAY_BUFFER, std::as_bytes(page.edges));
  glEnableVertexAttribArray(0);
  glVertexAttribIPointer(0, 2, GL_UNSIGNED_INT, sizeof(dyntri::Edge), nullptr);
  copy.triangles = makeBuffer(GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(page.triangles));
  if (Status status = checkGl("upload of a page"); !status.ok()) return status.fault();
  copy.bytes = page.vertices.size_bytes() + page.edges.size_bytes() + page.triangles.size_bytes();
  copy.number = number;
  copy.last_frame = frame_;
  copy.edge_count = static_cast<GLint>(page.edges.size());
  copy.key_count = static_cast<GLint>(page.edges.size() + page.vertices.size());
  bytes_ += copy.bytes;
  return &pages_.emplace(std::pair(source, number), std::move(copy)).first->second;
}

Status GlPages::bindColumn(GlPage& page, std::size_t column, std::span<const float> rows, int unit) {
  if (const auto found = page.columns.find(column); found != page.columns.end()) {
    found->second.bind(unit);
    return {};
  }
  auto made =
      makeTable(GL_R32F, std::as_bytes(rows), sizeof(float), unit, "column of page " + std::to_string(page.number));
  if (!made.ok()) return made.fault();
  page.columns.emplace(column, std::move(made).value());
  page.bytes += rows.size_bytes();
  bytes_ += rows.size_bytes();
  return {};
}

void GlPages::evict() {
  while (bytes_ > budget_bytes_) {
    const auto oldest = std::min_element(pages_.begin(), pages_.end(), [](const auto& a, const auto& b) {
      return a.second.last_frame < b.second.last_frame;
    });
    if (oldest == pages_.end() || oldest->second.last_frame == frame_) return;
    bytes_ -= oldest->second.bytes;
    pages_.erase(oldest);
  }
}

}  // namespace tet4d::render
