#include "player/render/gl_pages.h"

#include <algorithm>
#include <span>
#include <string>

namespace tet4d::render {
namespace {

struct Table {
  GLenum format;
  std::span<const std::byte> bytes;
  std::size_t texel_bytes;
};

}  // namespace

void GlPage::bind() const {
  for (std::size_t unit = 0; unit < tables.size(); ++unit) tables[unit].bind(static_cast<int>(unit));
}

Result<GlPage*> GlPages::get(std::size_t source, std::size_t number, const dyntri::PageView& page) {
  if (const auto found = pages_.find({source, number}); found != pages_.end()) {
    found->second.last_frame = frame_;
    return &found->second;
  }
  const Table tables[4] = {{GL_RGBA32F, std::as_bytes(page.vertices), 16},
                           {GL_RG32UI, std::as_bytes(page.edges), 8},
                           {GL_R32UI, std::as_bytes(page.triangles), 4},
                           {GL_RG32F, std::as_bytes(page.lifespans), 8}};
  GlPage copy;
  for (std::size_t unit = 0; unit < copy.tables.size(); ++unit) {
    const Table& table = tables[unit];
    auto made = makeTable(table.format, table.bytes, table.texel_bytes, static_cast<int>(unit),
                          "page " + std::to_string(number));
    if (!made.ok()) return made.fault();
    copy.tables[unit] = std::move(made).value();
    copy.bytes += table.bytes.size();
  }
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
