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

// A buffer texture of the table, bound to the unit.
Status upload(const Table& table, std::size_t number, int unit, GlBuffer& buffer, GlTexture& texture) {
  GLint most_texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most_texels);
  const std::size_t texels = table.bytes.size() / table.texel_bytes;
  if (texels > static_cast<std::size_t>(most_texels)) {
    return Fault{
        FaultCode::kOutOfMemory, "", "page " + std::to_string(number),
        "a table of " + std::to_string(texels) + " texels exceeds the driver's limit of " + std::to_string(most_texels),
        "use --renderer cpu"};
  }
  buffer = GlBuffer::create();
  texture = GlTexture::create();
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindBuffer(GL_TEXTURE_BUFFER, buffer.get());
  glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(table.bytes.size()), table.bytes.data(), GL_STATIC_DRAW);
  glBindTexture(GL_TEXTURE_BUFFER, texture.get());
  glTexBuffer(GL_TEXTURE_BUFFER, table.format, buffer.get());
  return {};
}

}  // namespace

void GlPage::bind() const {
  for (unsigned unit = 0; unit < 4; ++unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    glBindTexture(GL_TEXTURE_BUFFER, textures[unit].get());
  }
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
  for (unsigned unit = 0; unit < 4; ++unit) {
    if (Status status = upload(tables[unit], number, static_cast<int>(unit), copy.buffers[unit], copy.textures[unit]);
        !status.ok())
      return status.fault();
    copy.bytes += tables[unit].bytes.size();
  }
  if (Status status = checkGl("upload of a page"); !status.ok()) return status.fault();
  copy.number = number;
  copy.last_frame = frame_;
  copy.edge_count = static_cast<GLint>(page.edges.size());
  copy.key_count = static_cast<GLint>(page.edges.size() + page.vertices.size());
  bytes_ += copy.bytes;
  return &pages_.emplace(std::pair(source, number), std::move(copy)).first->second;
}

Status GlPages::bindColumn(GlPage& page, std::size_t column, std::span<const float> rows, int unit) {
  const auto [found, is_new] = page.columns.try_emplace(column);
  GlColumn& copy = found->second;
  if (!is_new) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_BUFFER, copy.texture.get());
    return {};
  }
  const Table table{GL_R32F, std::as_bytes(rows), sizeof(float)};
  Status status = upload(table, page.number, unit, copy.buffer, copy.texture);
  if (status.ok()) status = checkGl("upload of a column");
  if (!status.ok()) {
    page.columns.erase(found);
    return status;
  }
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
