#include "player/render/gl_renderer.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "player/render/gl_objects.h"
#include "player/render/gl_pages.h"
#include "player/render/gl_picture.h"
#include "player/render/gl_shading.h"
#include "player/render/gl_units.h"
#include "player/render/page_slice.h"
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
  GlProgram accumulate;
  GlSurfacePrograms smooth{"dyntri, smooth", "", shaders::kDyntriVert, nullptr};
  GlSurfacePrograms flat{"dyntri, flat", "#define BY_TRIANGLE\n#define FLAT\n", shaders::kDyntriVert,
                         shaders::kFlatGeom};
};

// Mesa's drivers without a GPU say so in their names.
bool hasGpu() {
  const auto* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string name = text != nullptr ? text : "";
  return name.find("llvmpipe") == std::string::npos && name.find("softpipe") == std::string::npos;
}

// Those of a surface of one colour are linked now, so that a driver which cannot is found out.
Result<Programs> makePrograms() {
  Programs programs;
  auto accumulate = GlProgram::link("dyntri, normals", "#define BY_TRIANGLE\n", shaders::kDyntriVert,
                                    shaders::kNormalsGeom, shaders::kNormalsFrag);
  if (!accumulate.ok()) return accumulate.fault();
  programs.accumulate = std::move(accumulate).value();
  for (GlSurfacePrograms* surfaces : {&programs.smooth, &programs.flat}) {
    if (const auto linked = surfaces->of({}); !linked.ok()) return linked.fault();
  }
  return programs;
}

class GlRenderer final : public Renderer {
 public:
  GlRenderer(Programs programs, GlPicture picture, std::uint64_t gpu_budget_bytes, bool plain_normals)
      : plain_normals_(plain_normals),
        programs_(std::move(programs)),
        picture_(std::move(picture)),
        pages_(gpu_budget_bytes) {}
  const char* name() const override { return "gl"; }
  std::uint64_t gpuBytes() const override { return pages_.bytes(); }

  std::size_t picturesAhead() const override { return 1; }

  Result<Image> draw(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    if (Status status = start(list, sources); !status.ok()) return status.fault();
    return take();
  }

  Status start(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    const auto grid = sampleGrid(list.format);
    if (!grid.ok()) return grid.fault();
    const auto width = static_cast<GLsizei>(list.format.width * grid.value());
    const auto height = static_cast<GLsizei>(list.format.height * grid.value());
    pages_.beginFrame();
    if (Status status = drawAll(list, sources, width, height); !status.ok()) {
      picture_.giveUp();
      return status;
    }
    pages_.evict();
    sides_.push_back(grid.value());
    return {};
  }

  Result<Image> take() override {
    const std::uint32_t side = sides_.front();
    Image image = sides_.size() == 1 ? picture_.read() : picture_.readBefore();
    sides_.erase(sides_.begin());
    if (Status status = checkGl("reading a picture"); !status.ok()) return status.fault();
    if (side == 1) return image;
    return boxFilter(image, side);
  }

 private:
  Status drawAll(const scene::DrawList& list, std::span<const stream::Residency* const> sources, GLsizei width,
                 GLsizei height) {
    if (Status status = picture_.begin(list, width, height); !status.ok()) return status;
    for (const scene::DrawSurface& surface : list.surfaces) {
      for (const auto items : itemsByPage(surface.items)) {
        if (Status status = drawPage(list, surface, items, *sources[surface.source]); !status.ok()) return status;
      }
    }
    glFlush();
    return checkGl("drawing");
  }

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
      Status status =
          plain_normals_ ? sumInPlainCode(surface, items, *view) : sumNormals(surface, items, *page.value());
      if (!status.ok()) return status;
    }
    const auto linked = (list.smooth ? programs_.smooth : programs_.flat).of(surface);
    if (!linked.ok()) return linked.fault();
    const GlProgram& program = *linked.value();
    program.use();
    setSlice(program, surface);
    setPlace(program, surface);
    shading_.set(program, list, surface);
    program.set("normal_sums", kNormalSumsUnit);
    program.set("file_normals", kFileNormalsUnit);
    program.set("column", kColumnUnit);
    program.set("edge_count", page.value()->edge_count);
    program.set("sums_size", std::max(sums_.width, 1), std::max(sums_.height, 1));
    program.set("has_file_normals", columns.value().has_normals ? 1 : 0);
    program.set("components", columns.value().components);
    program.set("component", surface.column ? surface.column->component : 0);
    program.set("page_value", scene::partValue(view->part));
    glActiveTexture(GL_TEXTURE0 + kNormalSumsUnit);
    glBindTexture(GL_TEXTURE_2D, sums_.texture.get());
    picture_.bind();
    if (list.smooth) glEnable(GL_CLIP_DISTANCE0);  // the flat program drops dead triangles itself
    drawRuns(items);
    glDisable(GL_CLIP_DISTANCE0);
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
    programs_.accumulate.use();
    setSlice(programs_.accumulate, surface);
    programs_.accumulate.set("edge_count", page.edge_count);
    programs_.accumulate.set("sums_size", sums_.width, sums_.height);
    drawRuns(items);
    return {};
  }

  // The same sums by the slicer of the plain renderer, written into the texture.
  Status sumInPlainCode(const scene::DrawSurface& surface, std::span<const scene::DrawItem> items,
                        const dyntri::PageView& page) {
    const std::size_t keys = page.edges.size() + page.vertices.size();
    const auto rows = static_cast<GLsizei>((keys + kSumsWidth - 1) / kSumsWidth);
    if (Status status = makeSums(rows); !status.ok()) return status;
    slicer_.slice(page, items, surface.t, surface.last_t, slice_);
    // Texels of keys that no living triangle has are left as they are: nothing reads them.
    const std::size_t texels = std::size_t{kSumsWidth} * static_cast<std::size_t>(rows);
    if (texels_.size() < texels) texels_.resize(texels);
    for (std::size_t i = 0; i < slice_.keys.size(); ++i) {
      const Vec3f& area = slice_.areas[i];
      texels_[slice_.keys[i]] = {area.x, area.y, area.z, 0};
    }
    glActiveTexture(GL_TEXTURE0 + kNormalSumsUnit);
    glBindTexture(GL_TEXTURE_2D, sums_.texture.get());
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kSumsWidth, rows, GL_RGBA, GL_FLOAT, texels_.data());
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

  // Of the page whose arrays are bound.
  static void drawRuns(std::span<const scene::DrawItem> items) {
    for (const scene::DrawItem& item : items) {
      const auto* first = reinterpret_cast<const void*>(item.first * sizeof(dyntri::Triangle));
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * item.count), GL_UNSIGNED_INT, first);
    }
  }

  bool plain_normals_;
  Programs programs_;
  GlPicture picture_;
  GlPages pages_;
  GlShading shading_;
  NormalSums sums_;
  PageSlicer slicer_;
  PageSlice slice_;
  std::vector<Vec4f> texels_;
  std::vector<std::uint32_t> sides_;  // sample grids of the pictures started and not taken: at most two
};

}  // namespace

Result<std::unique_ptr<Renderer>> makeGlRenderer(GlResolver resolver, std::uint64_t gpu_budget_bytes,
                                                 GlNormals normals) {
  if (Status status = loadGl(resolver); !status.ok()) return status.fault();
  const bool plain_normals = normals == GlNormals::kPlain || (normals == GlNormals::kAuto && !hasGpu());
  auto programs = makePrograms();
  if (!programs.ok()) return programs.fault();
  auto picture = GlPicture::create();
  if (!picture.ok()) return picture.fault();
  return std::unique_ptr<Renderer>(std::make_unique<GlRenderer>(std::move(programs).value(), std::move(picture).value(),
                                                                gpu_budget_bytes, plain_normals));
}

}  // namespace tet4d::render
