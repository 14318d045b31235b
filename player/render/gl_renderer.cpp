#include "player/render/gl_renderer.h"

#include <algorithm>
#include <string>
#include <utility>

#include "player/render/gl_objects.h"
#include "player/render/gl_pages.h"
#include "player/render/gl_picture.h"
#include "player/render/gl_shading.h"
#include "player/render/gl_units.h"
#include "player/render/shaders.h"

namespace tet4d::render {
namespace {

constexpr GLsizei kSumsWidth = 4096;  // texels; GL 3.3 promises at least 1024, checked against the driver's limit

// The texture in which slice vertices gather their normals; as large as the largest page so far.
struct NormalSums {
  GLsizei width = 0, height = 0;
  GlTexture texture;
  GlFramebuffer framebuffer;
};

struct Programs {
  GlProgram accumulate, smooth, flat;
};

Result<Programs> makePrograms() {
  Programs programs;
  auto accumulate =
      GlProgram::link("dyntri, normals", "#define ACCUMULATE\n", shaders::kDyntriVert, shaders::kNormalsFrag);
  if (!accumulate.ok()) return accumulate.fault();
  auto smooth = GlProgram::link("dyntri, smooth", "", shaders::kDyntriVert, shaders::kPhongFrag);
  if (!smooth.ok()) return smooth.fault();
  auto flat = GlProgram::link("dyntri, flat", "#define FLAT\n", shaders::kDyntriVert, shaders::kPhongFrag);
  if (!flat.ok()) return flat.fault();
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

void setPlace(const GlProgram& program, const scene::DrawSurface& surface) {
  program.set("normal_sums", kNormalSumsUnit);
  program.set("file_normals", kFileNormalsUnit);
  program.set("column", kColumnUnit);
  program.set("index_centre", surface.index_centre);
  program.set("index_to_relative", surface.index_to_relative);
  program.set("normal_to_relative", surface.normal_to_relative);
  program.set("offset", surface.offset);
}

class GlRenderer final : public Renderer {
 public:
  GlRenderer(Programs programs, GlPicture picture, std::uint64_t gpu_budget_bytes)
      : programs_(std::move(programs)),
        picture_(std::move(picture)),
        pages_(gpu_budget_bytes),
        no_attributes_(GlVertexArray::create()) {}
  const char* name() const override { return "gl"; }
  std::uint64_t gpuBytes() const override { return pages_.bytes(); }

  Result<Image> draw(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    const auto grid = sampleGrid(list.format);
    if (!grid.ok()) return grid.fault();
    const auto width = static_cast<GLsizei>(list.format.width * grid.value());
    const auto height = static_cast<GLsizei>(list.format.height * grid.value());
    pages_.beginFrame();
    if (Status status = picture_.begin(list, width, height); !status.ok()) return status.fault();
    glBindVertexArray(no_attributes_.get());
    for (const scene::DrawSurface& surface : list.surfaces) {
      for (const auto items : itemsByPage(surface.items)) {
        if (Status status = drawPage(list, surface, items, *sources[surface.source]); !status.ok())
          return status.fault();
      }
    }
    Image image = picture_.read();
    if (Status status = checkGl("drawing"); !status.ok()) return status.fault();
    pages_.evict();
    return boxFilter(image, grid.value());
  }

 private:
  Status drawPage(const scene::DrawList& list, const scene::DrawSurface& surface,
                  std::span<const scene::DrawItem> items, const stream::Residency& source) {
    const std::size_t number = items.front().page;
    const dyntri::PageView* view = source.resident(number);
    if (view == nullptr) return absentPage(number);
    auto page = pages_.get(surface.source, number, *view);
    if (!page.ok()) return page.fault();
    const auto columns = bindColumns(list, surface, *page.value(), number, source);
    if (!columns.ok()) return columns.fault();
    page.value()->bind();
    if (list.smooth && !columns.value().has_normals) {
      if (Status status = sumNormals(surface, items, *page.value()); !status.ok()) return status;
    }
    const GlProgram& program = list.smooth ? programs_.smooth : programs_.flat;
    setLookup(program, surface);
    setPlace(program, surface);
    shading_.set(program, list, surface);
    program.set("edge_count", page.value()->edge_count);
    program.set("sums_size", std::max(sums_.width, 1), std::max(sums_.height, 1));
    program.set("has_file_normals", columns.value().has_normals ? 1 : 0);
    program.set("components", columns.value().components);
    program.set("component", surface.column ? surface.column->component : 0);
    program.set("page_value", scene::partValue(view->part));
    glActiveTexture(GL_TEXTURE0 + kNormalSumsUnit);
    glBindTexture(GL_TEXTURE_2D, sums_.texture.get());
    picture_.bind();
    glFrontFace(surface.mirrored ? GL_CW : GL_CCW);
    drawCorners(GL_TRIANGLES, items);
    return {};
  }

  static constexpr int kPageValue = -1;  // one value for all of the page
  struct BoundColumns {
    bool has_normals = false;
    int components = 0;  // 0: no values
  };
  // The columns that the surface is drawn with, where they are resident.
  Result<BoundColumns> bindColumns(const scene::DrawList& list, const scene::DrawSurface& surface, GlPage& page,
                                   std::size_t number, const stream::Residency& source) {
    BoundColumns bound;
    const std::size_t vertices = static_cast<std::size_t>(page.key_count - page.edge_count);
    if (surface.column && surface.column->of_parts) {
      bound.components = kPageValue;
    } else if (surface.column) {
      const auto rows = source.residentColumn(number, surface.column->column);
      if (rows.size() >= surface.column->components * vertices) {
        if (Status status = pages_.bindColumn(page, surface.column->column, rows, kColumnUnit); !status.ok())
          return status.fault();
        bound.components = static_cast<int>(surface.column->components);
      }
    }
    if (list.smooth && surface.normal_column) {
      const auto rows = source.residentColumn(number, *surface.normal_column);
      if (rows.size() >= 3 * vertices) {
        if (Status status = pages_.bindColumn(page, *surface.normal_column, rows, kFileNormalsUnit); !status.ok())
          return status.fault();
        bound.has_normals = true;
      }
    }
    return bound;
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

  Programs programs_;
  GlPicture picture_;
  GlPages pages_;
  GlVertexArray no_attributes_;
  GlShading shading_;
  NormalSums sums_;
};

}  // namespace

Result<std::unique_ptr<Renderer>> makeGlRenderer(GlResolver resolver, std::uint64_t gpu_budget_bytes) {
  if (Status status = loadGl(resolver); !status.ok()) return status.fault();
  auto programs = makePrograms();
  if (!programs.ok()) return programs.fault();
  auto picture = GlPicture::create();
  if (!picture.ok()) return picture.fault();
  return std::unique_ptr<Renderer>(
      std::make_unique<GlRenderer>(std::move(programs).value(), std::move(picture).value(), gpu_budget_bytes));
}

}  // namespace tet4d::render
