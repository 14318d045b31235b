#include "player/render/gl_shading.h"

#include <string>
#include <utility>

#include "player/render/gl_picture.h"
#include "player/render/gl_units.h"
#include "player/render/shaders.h"

namespace tet4d::render {
namespace {

void setView(const GlProgram& program, const scene::DrawList& list) {
  program.set("relative_to_clip", list.relative_to_clip);
  program.set("perspective", list.perspective ? 1 : 0);
  program.set("eye_or_backward", list.eye_or_backward);
  program.set("light_count", static_cast<int>(list.lights.size()));
  for (std::size_t i = 0; i < list.lights.size(); ++i) {
    const std::string index = std::to_string(i) + "]";
    program.set(("light_toward[" + index).c_str(), list.lights[i].toward);
    program.set(("light_color[" + index).c_str(), list.lights[i].color);
  }
  program.set("ambient", list.ambient);
  program.set("up", list.up);
  program.set("background_top", list.background_top);
  program.set("background_bottom", list.background_bottom);
  program.set("behind", kBehindUnit);
}

}  // namespace

Result<const GlProgram*> GlSurfacePrograms::of(const scene::DrawSurface& surface) {
  std::string defines = defines_;
  if (surface.column) defines += "#define BY_COLUMN\n";
  if (surface.refraction > 0) defines += "#define REFRACTS\n";
  std::optional<GlProgram>& program = programs_[(surface.column ? 1U : 0U) + (surface.refraction > 0 ? 2U : 0U)];
  if (!program) {
    auto linked = GlProgram::link(name_, defines, vertex_, geometry_, shaders::kPhongFrag);
    if (!linked.ok()) return linked.fault();
    program = std::move(linked).value();
  }
  return &*program;
}

void setSlice(const GlProgram& program, const scene::DrawSurface& surface) {
  program.set("vertices", kVerticesUnit);
  program.set("t", surface.t);
  program.set("last_t", surface.last_t);
}

void setPlace(const GlProgram& program, const scene::DrawSurface& surface) {
  program.set("index_centre", surface.index_centre);
  program.set("index_to_relative", surface.index_to_relative);
  program.set("normal_to_relative", surface.normal_to_relative);
  program.set("offset", surface.offset);
  glFrontFace(surface.mirrored ? GL_CW : GL_CCW);
}

void GlShading::set(const GlProgram& program, const scene::DrawList& list, const scene::DrawSurface& surface) {
  setView(program, list);
  program.set("front_color", surface.front_color);
  program.set("back_color", surface.back_color);
  program.set("specular", surface.specular);
  program.set("shininess", surface.shininess);
  program.set("refraction", surface.refraction);
  program.set("tint", surface.tint);
  program.set("refraction_depth", list.refraction_depth * surface.depth);
  program.set("lit", surface.lit ? 1 : 0);
  if (!surface.column) return;
  program.set("color_table", kColorTableUnit);
  program.set("low", surface.column->low);
  program.set("high", surface.column->high);
  program.set("logarithmic", surface.column->logarithmic ? 1 : 0);
  program.set("below", surface.column->below);
  program.set("above", surface.column->above);
  program.set("unknown", surface.column->unknown);
  setTable(*surface.column);
}

void GlShading::setTable(const scene::DrawColumn& column) {
  constexpr GLsizei kEntries = static_cast<GLsizei>(scene::kMapEntries);
  if (!has_table_) color_table_ = makeTexture(GL_RGB32F, GL_RGB, GL_FLOAT, kEntries, 1);
  has_table_ = true;
  glActiveTexture(GL_TEXTURE0 + kColorTableUnit);
  glBindTexture(GL_TEXTURE_2D, color_table_.get());
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kEntries, 1, GL_RGB, GL_FLOAT, column.table.data());
}

}  // namespace tet4d::render
