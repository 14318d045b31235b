// The picture a GL renderer draws into: the background behind, colour and depth, rows read back from the top. Private
// to player/render.
#pragma once

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

  // Starts a picture of width x height samples with the list's background. If a surface refracts, a copy of it is bound
  // to kBehindUnit.
  Status begin(const scene::DrawList& list, GLsizei width, GLsizei height);

  // Draw calls go to the picture from here on, with depth test and without blending.
  void bind() const;

  Image read() const;

 private:
  Status makeTarget(GLsizei width, GLsizei height);
  void drawBackground(const scene::DrawList& list) const;
  void copyBackground();

  GlProgram background_, panel_;
  GlVertexArray no_attributes_;
  GLsizei width_ = 0, height_ = 0;
  GlTexture color_, depth_, behind_;
  GlFramebuffer framebuffer_;
  bool has_copy_ = false;
};

}  // namespace tet4d::render
