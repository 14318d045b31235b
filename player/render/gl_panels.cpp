#include "player/render/gl_panels.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "player/render/gl_objects.h"
#include "player/render/shaders.h"

namespace tet4d::render {
namespace {

GlTexture makeTexture(GLsizei width, GLsizei height, const void* pixels, GLint filter) {
  GlTexture texture = GlTexture::create();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.get());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

// GL's offsets into a bound buffer are spelt as pointers.
const void* offsetPointer(std::size_t offset) { return reinterpret_cast<const void*>(offset); }

}  // namespace

struct GlPanels::State {
  GlProgram gui, picture_program;
  GlVertexArray gui_array = GlVertexArray::create(), no_attributes = GlVertexArray::create();
  GlBuffer vertices = GlBuffer::create(), indices = GlBuffer::create();
  GlTexture atlas, picture;
  GLsizei picture_width = 0, picture_height = 0;
  // Off-screen.
  GlTexture color;
  GlFramebuffer framebuffer;
  GLsizei width = 0, height = 0;

  void describeVertices() const;
  void drawPicture() const;
  void drawPanels(const ImDrawData& panels, GLsizei fb_width, GLsizei fb_height) const;
  void drawList(const ImDrawList& list, const ImDrawData& panels, GLsizei fb_width, GLsizei fb_height) const;
  Status makeTarget(GLsizei w, GLsizei h);
};

void GlPanels::State::describeVertices() const {
  glBindVertexArray(gui_array.get());
  glBindBuffer(GL_ARRAY_BUFFER, vertices.get());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.get());
  constexpr GLsizei kStride = sizeof(ImDrawVert);
  for (const GLuint attribute : {0u, 1u, 2u}) glEnableVertexAttribArray(attribute);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, kStride, offsetPointer(offsetof(ImDrawVert, pos)));
  glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, kStride, offsetPointer(offsetof(ImDrawVert, uv)));
  glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, kStride, offsetPointer(offsetof(ImDrawVert, col)));
}

void GlPanels::State::drawPicture() const {
  glDisable(GL_BLEND);
  if (picture_width == 0) {
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    return;
  }
  glBindVertexArray(no_attributes.get());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, picture.get());
  picture_program.use();
  picture_program.set("picture", 0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void GlPanels::State::drawPanels(const ImDrawData& panels, GLsizei fb_width, GLsizei fb_height) const {
  if (!(panels.DisplaySize.x > 0 && panels.DisplaySize.y > 0)) return;
  glBindVertexArray(gui_array.get());
  gui.use();
  gui.set("atlas", 0);
  gui.set("origin", panels.DisplayPos.x, panels.DisplayPos.y);
  gui.set("extent", panels.DisplaySize.x, panels.DisplaySize.y);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_SCISSOR_TEST);
  for (int i = 0; i < panels.CmdListsCount; ++i) drawList(*panels.CmdLists[i], panels, fb_width, fb_height);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
}

void GlPanels::State::drawList(const ImDrawList& list, const ImDrawData& panels, GLsizei fb_width,
                               GLsizei fb_height) const {
  glBindBuffer(GL_ARRAY_BUFFER, vertices.get());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.VtxBuffer.size_in_bytes()), list.VtxBuffer.Data,
               GL_STREAM_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.IdxBuffer.size_in_bytes()), list.IdxBuffer.Data,
               GL_STREAM_DRAW);
  constexpr GLenum kIndexType = sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  const ImVec2 scale = panels.FramebufferScale, origin = panels.DisplayPos;
  for (const ImDrawCmd& command : list.CmdBuffer) {
    if (command.UserCallback != nullptr || command.ElemCount == 0) continue;  // our panels have no callbacks
    const auto left = static_cast<GLint>(std::floor((command.ClipRect.x - origin.x) * scale.x));
    const auto top = static_cast<GLint>(std::floor((command.ClipRect.y - origin.y) * scale.y));
    const auto right = std::min(static_cast<GLint>(std::ceil((command.ClipRect.z - origin.x) * scale.x)), fb_width);
    const auto bottom = std::min(static_cast<GLint>(std::ceil((command.ClipRect.w - origin.y) * scale.y)), fb_height);
    const GLint x = std::max(left, 0), y = std::max(top, 0);
    if (right <= x || bottom <= y) continue;
    glScissor(x, fb_height - bottom, right - x, bottom - y);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, atlas.get());
    // Indices of 16 bits count from the command's first vertex.
    glDrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), kIndexType,
                             offsetPointer(command.IdxOffset * sizeof(ImDrawIdx)),
                             static_cast<GLint>(command.VtxOffset));
  }
}

Status GlPanels::State::makeTarget(GLsizei w, GLsizei h) {
  if (width == w && height == h) return {};
  color = makeTexture(w, h, nullptr, GL_NEAREST);
  framebuffer = GlFramebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.get());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color.get(), 0);
  if (Status status = checkGl("panels"); !status.ok()) return status;
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return Fault{FaultCode::kOutOfMemory, "", "panels", "the driver gives no buffer of the picture's size",
                 "give a smaller --size"};
  }
  width = w;
  height = h;
  return {};
}

GlPanels::GlPanels() : state_(std::make_unique<State>()) {}
GlPanels::~GlPanels() = default;

Result<std::unique_ptr<GlPanels>> GlPanels::create(GlResolver resolver) {
  if (Status status = loadGl(resolver); !status.ok()) return status.fault();
  auto gui = GlProgram::link("gui", "", shaders::kGuiVert, nullptr, shaders::kGuiFrag);
  if (!gui.ok()) return gui.fault();
  auto picture = GlProgram::link("picture", "", shaders::kPictureVert, nullptr, shaders::kPictureFrag);
  if (!picture.ok()) return picture.fault();
  std::unique_ptr<GlPanels> panels(new GlPanels());
  panels->state_->gui = std::move(gui).value();
  panels->state_->picture_program = std::move(picture).value();
  panels->state_->describeVertices();
  ImGuiIO& io = ImGui::GetIO();
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  io.BackendRendererName = "tet4d";
  panels->uploadFonts();
  if (Status status = checkGl("panels"); !status.ok()) return status.fault();
  return panels;
}

void GlPanels::uploadFonts() {
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
  state_->atlas = makeTexture(width, height, pixels, GL_LINEAR);
}

Status GlPanels::setPicture(const Image& picture) {
  const auto width = static_cast<GLsizei>(picture.width), height = static_cast<GLsizei>(picture.height);
  if (width == state_->picture_width && height == state_->picture_height) {
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, state_->picture.get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, picture.rgba.data());
  } else {
    state_->picture = makeTexture(width, height, picture.rgba.data(), GL_LINEAR);
    state_->picture_width = width;
    state_->picture_height = height;
  }
  return checkGl("the picture behind the panels");
}

Status GlPanels::draw(const ImDrawData* panels, unsigned framebuffer, std::uint32_t width, std::uint32_t height) {
  const auto w = static_cast<GLsizei>(width), h = static_cast<GLsizei>(height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, w, h);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  state_->drawPicture();
  if (panels != nullptr) state_->drawPanels(*panels, w, h);
  glBindVertexArray(0);
  return checkGl("panels");
}

Result<Image> GlPanels::drawOffscreen(const ImDrawData* panels, std::uint32_t width, std::uint32_t height) {
  if (Status status = state_->makeTarget(static_cast<GLsizei>(width), static_cast<GLsizei>(height)); !status.ok())
    return status.fault();
  if (Status status = draw(panels, state_->framebuffer.get(), width, height); !status.ok()) return status.fault();
  return read(state_->framebuffer.get(), width, height);
}

Result<Image> GlPanels::read(unsigned framebuffer, std::uint32_t width, std::uint32_t height) {
  Image image(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA, GL_UNSIGNED_BYTE,
               image.rgba.data());
  if (Status status = checkGl("reading the window"); !status.ok()) return status.fault();
  for (std::uint32_t y = 0; y < height / 2; ++y)
    std::swap_ranges(image.row(y), image.row(y) + std::size_t{4} * width, image.row(height - 1 - y));
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

}  // namespace tet4d::render
