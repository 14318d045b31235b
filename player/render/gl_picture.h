// The picture a GL renderer draws into: the background behind, colour and depth, rows read back from the top. Private
// to player/render.
#pragma once

#include <array>
#include <cstddef>

#include "player/render/gl_objects.h"
#include "player/render/image.h"
#include "player/scene/draw_list.h"

namespace tet4d::render {

// A texture without filtering, bound to unit kScratchUnit.
GlTexture makeTexture(GLenum internal_format, GLenum format, GLenum type, GLsizei width, GLsizei height);

// Of the framebuffer that is bound: Fault kOutOfMemory if the driver refuses it.
Status checkFramebuffer(const char* what, GLsizei width, GLsizei height);

class GlPicture {
 public:
  // Compiles the background's programs in the current context.
  static Result<GlPicture> create();

  // Starts a picture of width x height samples with the list's background, in one of two targets by turns. If a surface
  // refracts, a copy of the background is bound to kBehindUnit.
  Status begin(const scene::DrawList& list, GLsizei width, GLsizei height);

  // The picture begun last will not be finished, or could not be begun: the one before it is the last again.
  void giveUp() { current_ = 1 - current_; }

  // Draw calls go to the picture from here on, with depth test and without blending.
  void bind() const;

  // The picture begun last, or the one before it: read while this one is being drawn, it costs no wait.
  Image read() const { return readTarget(targets_[current_]); }
  Image readBefore() const { return readTarget(targets_[1 - current_]); }

 private:
  struct Target {
    GLsizei width = 0, height = 0;
    GlTexture color;
    GlFramebuffer framebuffer;
  };
  Status makeTarget(GLsizei width, GLsizei height);
  static Image readTarget(const Target& target);
  void drawBackground(const scene::DrawList& list) const;
  void copyBackground();

  GlProgram background_, panel_;
  GlVertexArray no_attributes_;
  std::array<Target, 2> targets_;
  std::size_t current_ = 0;
  GLsizei depth_width_ = 0, depth_height_ = 0, copy_width_ = 0, copy_height_ = 0;
  GlTexture depth_, behind_;  // of both targets: what one picture writes is of no use to the next
};

}  // namespace tet4d::render
