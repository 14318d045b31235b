// The uniforms of shaders/phong.frag.glsl. Private to player/render.
#pragma once

#include "player/render/gl_objects.h"
#include "player/scene/draw_list.h"

namespace tet4d::render {

class GlShading {
 public:
  // Of the program in use: camera, lights, background, and what `surface` is made of. Binds the surface's colour table.
  void set(const GlProgram& program, const scene::DrawList& list, const scene::DrawSurface& surface);

 private:
  void setTable(const scene::DrawColumn& column);

  GlTexture color_table_;
  bool has_table_ = false;
};

}  // namespace tet4d::render
