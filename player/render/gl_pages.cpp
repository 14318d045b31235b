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
  for (unsigned unit = 0; unit < 4; ++unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    glBindTexture(GL_TEXTURE_BUFFER, textures[unit].get());
  }
}

Result<const GlPage*> GlPages::get(std::size_t source, std::size_t number, const dyntri::PageView& page) {
  if (const auto found = pages_.find({source, number}); found != pages_.end()) {
    found->second.last_frame = frame_;
    return &found->second;
  }
  const Table tables[4] = {{GL_RGBA32F, std::as_bytes(page.vertices), 16},
                           {GL_RG32UI, std::as_bytes(page.edges), 8},
                           {GL_R32UI, std::as_bytes(page.triangles), 4},
                           {GL_RG32F, std::as_bytes(page.lifespans), 8}};
  GLint most_texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most_texels);
  GlPage copy;
  for (unsigned unit = 0; unit < 4; ++unit) {
    const Table& table = tables[unit];
    const std::size_t texels = table.bytes.size() / table.texel_bytes;
    if (texels > static_cast<std::size_t>(most_texels)) {
      return Fault{FaultCode::kOutOfMemory, "", "page " + std::to_string(number),
                   "a table of " + std::to_string(texels) + " texels exceeds the driver's limit of " +
                       std::to_string(most_texels),
                   "use --renderer cpu"};
    }
    copy.buffers[unit] = GlBuffer::create();
    copy.textures[unit] = GlTexture::create();
    glActiveTexture(GL_TEXTURE0 + unit);
    glBindBuffer(GL_TEXTURE_BUFFER, copy.buffers[unit].get());
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(table.bytes.size()), table.bytes.data(), GL_STATIC_DRAW);
    glBindTexture(GL_TEXTURE_BUFFER, copy.textures[unit].get());
    glTexBuffer(GL_TEXTURE_BUFFER, table.format, copy.buffers[unit].get());
    copy.bytes += table.bytes.size();
  }
  if (Status status = checkGl("upload of a page"); !status.ok()) return status.fault();
  copy.last_frame = frame_;
  copy.edge_count = static_cast<GLint>(page.edges.size());
  copy.key_count = static_cast<GLint>(page.edges.size() + page.vertices.size());
  bytes_ += copy.bytes;
  return &pages_.emplace(std::pair(source, number), std::move(copy)).first->second;
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
