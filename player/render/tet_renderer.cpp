#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "player/render/gl_objects.h"
#include "player/render/gl_picture.h"
#include "player/render/gl_renderer.h"
#include "player/render/gl_shading.h"
#include "player/render/gl_units.h"
#include "player/render/shaders.h"

namespace tet4d::render {
namespace {

struct TetCopy {
  GlTable vertices, tets;
  std::uint64_t bytes = 0, last_frame = 0;
  GLsizei corners = 0;
};

class TetRenderer final : public Renderer {
 public:
  TetRenderer(GlSurfacePrograms programs, GlPicture picture, std::uint64_t gpu_budget_bytes)
      : programs_(std::move(programs)),
        picture_(std::move(picture)),
        no_attributes_(GlVertexArray::create()),
        budget_bytes_(gpu_budget_bytes) {}
  const char* name() const override { return "tets"; }
  std::uint64_t gpuBytes() const override { return bytes_; }

  Result<Image> draw(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    const auto grid = sampleGrid(list.format);
    if (!grid.ok()) return grid.fault();
    ++frame_;
    evict();
    if (Status status = picture_.begin(list, static_cast<GLsizei>(list.format.width * grid.value()),
                                       static_cast<GLsizei>(list.format.height * grid.value()));
        !status.ok())
      return status.fault();
    picture_.bind();
    glBindVertexArray(no_attributes_.get());
    for (const scene::DrawSurface& surface : list.surfaces) {
      if (Status status = setSurface(list, surface); !status.ok()) return status.fault();
      for (const auto items : itemsByPage(surface.items)) {
        const auto copy = copyOf(surface.source, items.front().page, *sources[surface.source]);
        if (!copy.ok()) return copy.fault();
        copy.value()->vertices.bind(kVerticesUnit);
        copy.value()->tets.bind(kTetsUnit);
        glDrawArrays(GL_TRIANGLES, 0, copy.value()->corners);
      }
    }
    Image image = picture_.read();
    if (Status status = checkGl("drawing"); !status.ok()) return status.fault();
    return boxFilter(image, grid.value());
  }

 private:
  Status setSurface(const scene::DrawList& list, const scene::DrawSurface& surface) {
    const auto linked = programs_.of(surface);
    if (!linked.ok()) return linked.fault();
    const GlProgram& program = *linked.value();
    program.use();
    program.set("tets", kTetsUnit);
    setSlice(program, surface);
    setPlace(program, surface);
    shading_.set(program, list, surface);
    return {};
  }

  // The driver's copy of a page: 16 bytes a vertex and 16 a tetrahedron.
  Result<const TetCopy*> copyOf(std::size_t source, std::size_t number, const stream::Residency& pages) {
    if (const auto found = copies_.find({source, number}); found != copies_.end()) {
      found->second.last_frame = frame_;
      return &found->second;
    }
    const auto page = pages.residentTets(number);
    if (!page) return absentPage(number);
    constexpr std::size_t kMostTets = std::size_t{0x7fffffff} / 6;  // a draw call counts corners in 31 bits
    const std::string place = "page " + std::to_string(number);
    if (page->tets.size() > kMostTets)
      return Fault{FaultCode::kOutOfMemory, "", place, "has too many tetrahedra for one draw call",
                   "run dyntri-build and play its output"};
    auto vertices = makeTable(GL_RGBA32F, std::as_bytes(page->vertices), sizeof(Vec4f), kVerticesUnit, place);
    if (!vertices.ok()) return vertices.fault();
    auto tets = makeTable(GL_RGBA32UI, std::as_bytes(page->tets), 16, kTetsUnit, place);
    if (!tets.ok()) return tets.fault();
    const std::uint64_t bytes = page->vertices.size_bytes() + page->tets.size_bytes();
    bytes_ += bytes;
    TetCopy copy{std::move(vertices).value(), std::move(tets).value(), bytes, frame_,
                 static_cast<GLsizei>(6 * page->tets.size())};
    return &copies_.emplace(std::pair(source, number), std::move(copy)).first->second;
  }

  void evict() {
    while (bytes_ > budget_bytes_ && !copies_.empty()) {
      const auto oldest = std::min_element(copies_.begin(), copies_.end(), [](const auto& a, const auto& b) {
        return a.second.last_frame < b.second.last_frame;
      });
      bytes_ -= oldest->second.bytes;
      copies_.erase(oldest);
    }
  }

  GlSurfacePrograms programs_;
  GlPicture picture_;
  GlShading shading_;
  GlVertexArray no_attributes_;
  std::uint64_t budget_bytes_, bytes_ = 0, frame_ = 0;
  std::map<std::pair<std::size_t, std::size_t>, TetCopy> copies_;  // by source and number
};

}  // namespace

Result<std::unique_ptr<Renderer>> makeTetRenderer(GlResolver resolver, std::uint64_t gpu_budget_bytes) {
  if (Status status = loadGl(resolver); !status.ok()) return status.fault();
  GlSurfacePrograms programs("tets", "", shaders::kTetsVert, nullptr);
  if (const auto linked = programs.of({}); !linked.ok()) return linked.fault();
  auto picture = GlPicture::create();
  if (!picture.ok()) return picture.fault();
  return std::unique_ptr<Renderer>(
      std::make_unique<TetRenderer>(std::move(programs), std::move(picture).value(), gpu_budget_bytes));
}

}  // namespace tet4d::render
