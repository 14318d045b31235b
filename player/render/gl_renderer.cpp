#include "player/render/gl_renderer.h"

#include <algorithm>
#include <string>
#include <utility>

#include "player/render/gl_objects.h"
#include "player/render/gl_pages.h"
#include "player/render/shaders.h"

namespace tet4d::render {
namespace {

constexpr GLsizei kSumsWidth = 4096;  // texels; GL 3.3 promises at least 1024, checked against the driver's limit

// A colour and a depth buffer to draw into.
struct Target {
  GLsizei width = 0, height = 0;
  GlTexture color, depth;
  GlFramebuffer framebuffer;
};

// The texture in which slice vertices gather their normals; as large as the largest page so far.
struct NormalSums {
  GLsizei width = 0, height = 0;
  GlTexture texture;
  GlFramebuffer framebuffer;
};

GlTexture makeTexture(GLenum internal_format, GLenum format, GLenum type, GLsizei width, GLsizei height) {
  GlTexture texture = GlTexture::create();
  glActiveTexture(GL_TEXTURE0 + kNormalSumsUnit);
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

struct Programs {
  GlProgram background, panel, accumulate, smooth, flat;
};

Result<Programs> makePrograms() {
  Programs programs;
  auto background = GlProgram::link("background", "", shaders::kBackgroundVert, shaders::kBackgroundFrag);
  if (!background.ok()) return background.fault();
  auto panel = GlProgram::link("panel", "", shaders::kPanelVert, shaders::kPanelFrag);
  if (!panel.ok()) return panel.fault();
  auto accumulate =
      GlProgram::link("dyntri, normals", "#define ACCUMULATE\n", shaders::kDyntriVert, shaders::kNormalsFrag);
  if (!accumulate.ok()) return accumulate.fault();
  auto smooth = GlProgram::link("dyntri, smooth", "", shaders::kDyntriVert, shaders::kPhongFrag);
  if (!smooth.ok()) return smooth.fault();
  auto flat = GlProgram::link("dyntri, flat", "#define FLAT\n", shaders::kDyntriVert, shaders::kPhongFrag);
  if (!flat.ok()) return flat.fault();
  programs.background = std::move(background).value();
  programs.panel = std::move(panel).value();
  programs.accumulate = std::move(accumulate).value();
  programs.smooth = std::move(smooth).value();
  programs.flat = std::move(flat).value();
  return programs;
}

void setLookup(const GlProgram& program, const scene::DrawSurface& surface) {
  program.use();
  program.set("vertices", kVerticesUnit);
  program.set("edges", kEdgesUnit);
  program.set("triangles", kTrianglesUnit);
  program.set("lifespans", kLifespansUnit);
  program.set("t", surface.t);
  program.set("last_t", surface.last_t);
}

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
}

void setSurface(const GlProgram& program, const scene::DrawSurface& surface) {
  program.set("normal_sums", kNormalSumsUnit);
  program.set("index_centre", surface.index_centre);
  program.set("index_to_relative", surface.index_to_relative);
  program.set("normal_to_relative", surface.normal_to_relative);
  program.set("offset", surface.offset);
  program.set("front_color", surface.front_color);
  program.set("back_color", surface.back_color);
  program.set("specular", surface.specular);
  program.set("shininess", surface.shininess);
}

class GlRenderer final : public Renderer {
 public:
  GlRenderer(Programs programs, std::uint64_t gpu_budget_bytes)
      : programs_(std::move(programs)), pages_(gpu_budget_bytes), no_attributes_(GlVertexArray::create()) {}
  const char* name() const override { return "gl"; }

  Result<Image> draw(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    const auto grid = sampleGrid(list.format);
    if (!grid.ok()) return grid.fault();
    const auto width = static_cast<GLsizei>(list.format.width * grid.value());
    const auto height = static_cast<GLsizei>(list.format.height * grid.value());
    if (Status status = makeTarget(width, height); !status.ok()) return status.fault();
    pages_.beginFrame();
    glBindVertexArray(no_attributes_.get());
    drawBackground(list);
    for (const scene::DrawSurface& surface : list.surfaces) {
      for (const auto items : itemsByPage(surface.items)) {
        if (Status status = drawPage(list, surface, items, *sources[surface.source]); !status.ok())
          return status.fault();
      }
    }
    Image image = readBack();
    if (Status status = checkGl("drawing"); !status.ok()) return status.fault();
    pages_.evict();
    return boxFilter(image, grid.value());
  }

 private:
  Status makeTarget(GLsizei width, GLsizei height) {
    if (target_.width == width && target_.height == height) return {};
    Target target;
    target.color = makeTexture(GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, width, height);
    target.depth = makeTexture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, width, height);
    target.framebuffer = GlFramebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.color.get(), 0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, target.depth.get(), 0);
    if (Status status = checkFramebuffer("picture", width, height); !status.ok()) return status;
    target.width = width;
    target.height = height;
    target_ = std::move(target);
    return {};
  }

  void drawBackground(const scene::DrawList& list) {
    bindTarget();
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glClearDepth(1);
    glClear(GL_DEPTH_BUFFER_BIT);
    programs_.background.use();
    programs_.background.set("top", list.background_top);
    programs_.background.set("bottom", list.background_bottom);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    programs_.panel.use();
    programs_.panel.set("relative_to_clip", list.relative_to_clip);
    for (const scene::DrawPanel& panel : list.panels) {
      programs_.panel.set("panel_color", panel.color);
      for (std::size_t k = 0; k < 4; ++k) {
        programs_.panel.set(("corners[" + std::to_string(k) + "]").c_str(), panel.corners[k]);
      }
      glDrawArrays(GL_TRIANGLE_FAN, 0, 4);
    }
  }

  void bindTarget() {
    glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer.get());
    glViewport(0, 0, target_.width, target_.height);
  }

  Status drawPage(const scene::DrawList& list, const scene::DrawSurface& surface,
                  std::span<const scene::DrawItem> items, const stream::Residency& source) {
    const std::size_t number = items.front().page;
    const dyntri::PageView* view = source.resident(number);
    if (view == nullptr) return absentPage(number);
    auto page = pages_.get(surface.source, number, *view);
    if (!page.ok()) return page.fault();
    page.value()->bind();
    if (list.smooth) {
      if (Status status = sumNormals(surface, items, *page.value()); !status.ok()) return status;
    }
    const GlProgram& program = list.smooth ? programs_.smooth : programs_.flat;
    setLookup(program, surface);
    setView(program, list);
    setSurface(program, surface);
    program.set("edge_count", page.value()->edge_count);
    program.set("sums_size", std::max(sums_.width, 1), std::max(sums_.height, 1));
    glActiveTexture(GL_TEXTURE0 + kNormalSumsUnit);
    glBindTexture(GL_TEXTURE_2D, sums_.texture.get());
    bindTarget();
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glFrontFace(surface.mirrored ? GL_CW : GL_CCW);
    drawCorners(GL_TRIANGLES, items);
    return {};
  }

  // Pass 1: every corner of a living triangle adds the triangle's area vector to its slice vertex's texel.
  Status sumNormals(const scene::DrawSurface& surface, std::span<const scene::DrawItem> items, const GlPage& page) {
    const GLsizei rows = (page.key_count + kSumsWidth - 1) / kSumsWidth;
    if (Status status = makeSums(rows); !status.ok()) return status;
    glBindFramebuffer(GL_FRAMEBUFFER, sums_.framebuffer.get());
    glViewport(0, 0, sums_.width, sums_.height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, sums_.width, rows);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    setLookup(programs_.accumulate, surface);
    programs_.accumulate.set("edge_count", page.edge_count);
    programs_.accumulate.set("sums_size", sums_.width, sums_.height);
    drawCorners(GL_POINTS, items);
    return {};
  }

  Status makeSums(GLsizei rows) {
    if (rows <= sums_.height) return {};
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (rows > most || kSumsWidth > most) {
      return Fault{FaultCode::kOutOfMemory, "", "normals", "a page has more slice vertices than the driver's textures",
                   "use --flat or --renderer cpu"};
    }
    NormalSums sums;
    sums.texture = makeTexture(GL_RGBA32F, GL_RGBA, GL_FLOAT, kSumsWidth, rows);
    sums.framebuffer = GlFramebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, sums.framebuffer.get());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, sums.texture.get(), 0);
    if (Status status = checkFramebuffer("normals", kSumsWidth, rows); !status.ok()) return status;
    sums.width = kSumsWidth;
    sums.height = rows;
    sums_ = std::move(sums);
    return {};
  }

  static void drawCorners(GLenum mode, std::span<const scene::DrawItem> items) {
    for (const scene::DrawItem& item : items)
      glDrawArrays(mode, static_cast<GLint>(3 * item.first), static_cast<GLsizei>(3 * item.count));
  }

  Image readBack() const {
    Image flipped(static_cast<std::uint32_t>(target_.width), static_cast<std::uint32_t>(target_.height));
    glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer.get());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, target_.width, target_.height, GL_RGBA, GL_UNSIGNED_BYTE, flipped.rgba.data());
    for (std::uint32_t y = 0; y < flipped.height / 2; ++y) {
      std::swap_ranges(flipped.row(y), flipped.row(y) + std::size_t{4} * flipped.width,
                       flipped.row(flipped.height - 1 - y));
    }
    return flipped;
  }

  Programs programs_;
  GlPages pages_;
  GlVertexArray no_attributes_;
  Target target_;
  NormalSums sums_;
};

}  // namespace

Result<std::unique_ptr<Renderer>> makeGlRenderer(GlResolver resolver, std::uint64_t gpu_budget_bytes) {
  if (Status status = loadGl(resolver); !status.ok()) return status.fault();
  auto programs = makePrograms();
  if (!programs.ok()) return programs.fault();
  return std::unique_ptr<Renderer>(std::make_unique<GlRenderer>(std::move(programs).value(), gpu_budget_bytes));
}

}  // namespace tet4d::render
