// The uniforms of shaders/phong.frag.glsl. Private to player/render.
#pragma once

#include <array>
#include <optional>

#include "player/render/gl_objects.h"
#include "player/scene/draw_list.h"

namespace tet4d::render {

// Of the program in use: the vertices' table, and when they are sliced.
void setSlice(const GlProgram& program, const scene::DrawSurface& surface);
// Of the program in use: where the slice lies; and which way its triangles turn.
void setPlace(const GlProgram& program, const scene::DrawSurface& surface);

// Programs that draw surfaces with shaders/phong.frag, one for each kind of surface, compiled when it is first drawn.
class GlSurfacePrograms {
 public:
  // `defines`, `vertex`, `geometry`: see GlProgram::link().
  GlSurfacePrograms(const char* name, const char* defines, const char* vertex, const char* geometry)
      : name_(name), defines_(defines), vertex_(vertex), geometry_(geometry) {}
  // The program that draws `surface`.
  Result<const GlProgram*> of(const scene::DrawSurface& surface);

 private:
  const char* name_;
  const char* defines_;
  const char* vertex_;
  const char* geometry_;
  std::array<std::optional<GlProgram>, 4> programs_;
};

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
