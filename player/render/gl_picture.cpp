#include "player/render/gl_picture.h"

#include <algorithm>
#include <string>
#include <utility>

#include "player/render/gl_units.h"
#include "player/render/shaders.h"

namespace tet4d::render {

GlTexture makeTexture(GLenum internal_format, GLenum format, GLenum type, GLsizei width, GLsizei height) {
  GlTexture texture = GlTexture::create();
  glActiveTexture(GL_TEXTURE0 + kScratchUnit);
  glBindTexture(GL_TEXTURE_2D, texture.get());
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

Status checkFramebuffer(const char* what, GLsizei width, GLsizei height) {
  if (Status status = checkGl(what); !status.ok()) return status;
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return {};
  return Fault{FaultCode::kOutOfMemory, "", what,
               "the driver gives no buffer of " + std::to_string(width) + "x" + std::to_string(height),
               "give a smaller --size or fewer --samples, or use --renderer cpu"};
}

Result<GlPicture> GlPicture::create() {
  GlPicture picture;
  auto background = GlProgram::link("background", "", shaders::kBackgroundVert, nullptr, shaders::kBackgroundFrag);
  if (!background.ok()) return background.fault();
  auto panel = GlProgram::link("panel", "", shaders::kPanelVert, nullptr, shaders::kPanelFrag);
  if (!panel.ok()) return panel.fault();
  picture.background_ = std::move(background).value();
  picture.panel_ = std::move(panel).value();
  picture.no_attributes_ = GlVertexArray::create();
  return picture;
}

Status GlPicture::begin(const scene::DrawList& list, GLsizei width, GLsizei height) {
  if (Status status = makeTarget(width, height); !status.ok()) return status;
  drawBackground(list);
  if (list.refracts()) copyBackground();
  return checkGl("background");
}

Status GlPicture::makeTarget(GLsizei width, GLsizei height) {
  current_ = 1 - current_;
  Target& target = targets_[current_];
  if (depth_width_ != width || depth_height_ != height) {
    depth_ = makeTexture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, width, height);
    depth_width_ = width;
    depth_height_ = height;
    target.width = 0;  // its depth is another one
  }
  if (target.width == width && target.height == height) return {};
  target.width = 0;
  target.color = makeTexture(GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, width, height);
  target.framebuffer = GlFramebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.color.get(), 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.get(), 0);
  if (Status status = checkFramebuffer("picture", width, height); !status.ok()) {
    depth_width_ = 0;
    return status;
  }
  target.width = width;
  target.height = height;
  return {};
}

void GlPicture::drawBackground(const scene::DrawList& list) const {
  bind();
  glBindVertexArray(no_attributes_.get());
  glDisable(GL_DEPTH_TEST);
  glClearDepth(1);
  glClear(GL_DEPTH_BUFFER_BIT);
  background_.use();
  background_.set("top", list.background_top);
  background_.set("bottom", list.background_bottom);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  panel_.use();
  panel_.set("relative_to_clip", list.relative_to_clip);
  panel_.set("checker_shade", scene::kCheckerShade);
  for (const scene::DrawPanel& panel : list.panels) {
    panel_.set("panel_color", panel.color);
    panel_.set("squares", panel.squares.x, panel.squares.y);
    for (std::size_t k = 0; k < 4; ++k) panel_.set(("corners[" + std::to_string(k) + "]").c_str(), panel.corners[k]);
    glDrawArrays(GL_TRIANGLE_FAN, 0, 4);
  }
}

void GlPicture::copyBackground() {
  const Target& target = targets_[current_];
  if (copy_width_ != target.width || copy_height_ != target.height)
    behind_ = makeTexture(GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, target.width, target.height);
  copy_width_ = target.width;
  copy_height_ = target.height;
  glActiveTexture(GL_TEXTURE0 + kBehindUnit);
  glBindTexture(GL_TEXTURE_2D, behind_.get());
  glCopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, target.width, target.height);
}

void GlPicture::bind() const {
  const Target& target = targets_[current_];
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
  glViewport(0, 0, target.width, target.height);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
}

Image GlPicture::readTarget(const Target& target) {
  Image flipped(static_cast<std::uint32_t>(target.width), static_cast<std::uint32_t>(target.height));
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, target.width, target.height, GL_RGBA, GL_UNSIGNED_BYTE, flipped.rgba.data());
  for (std::uint32_t y = 0; y < flipped.height / 2; ++y) {
    std::swap_ranges(flipped.row(y), flipped.row(y) + std::size_t{4} * flipped.width,
                     flipped.row(flipped.height - 1 - y));
  }
  return flipped;
}

}  // namespace tet4d::render
