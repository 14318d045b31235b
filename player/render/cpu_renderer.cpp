#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <thread>

#include "player/render/page_slice.h"
#include "player/render/phong.h"
#include "player/render/raster.h"
#include "player/render/renderer.h"

namespace tet4d::render {
namespace {

glm::vec3 toGlm(const Vec3f& v) { return {v.x, v.y, v.z}; }

glm::vec3 unitOrZero(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

RasterVertex project(const scene::DrawList& list, const scene::DrawSurface& surface, const Vec3f& index) {
  const glm::vec3 relative = surface.index_to_relative * (toGlm(index) - surface.index_centre) + surface.offset;
  return {list.relative_to_clip * glm::vec4(relative, 1), relative, glm::vec3(0)};
}

void addSmooth(const scene::DrawList& list, const scene::DrawSurface& surface, const PageSlice& slice, Raster& raster) {
  std::vector<RasterVertex> vertices(slice.positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i] = project(list, surface, slice.positions[i]);
    vertices[i].normal = unitOrZero(surface.normal_to_relative * toGlm(slice.areas[i]));
  }
  for (const auto& [a, b, c] : slice.triangles) raster.add(vertices[a], vertices[b], vertices[c]);
}

void addFlat(const scene::DrawList& list, const scene::DrawSurface& surface, const PageSlice& slice, Raster& raster) {
  for (const auto& triangle : slice.triangles) {
    std::array<RasterVertex, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = project(list, surface, slice.positions[triangle[k]]);
    const glm::vec3 origin = toGlm(slice.positions[triangle[0]]);
    const glm::vec3 area =
        glm::cross(toGlm(slice.positions[triangle[1]]) - origin, toGlm(slice.positions[triangle[2]]) - origin);
    for (RasterVertex& corner : corners) corner.normal = unitOrZero(surface.normal_to_relative * area);
    raster.add(corners[0], corners[1], corners[2]);
  }
}

// The walls behind everything, in a raster of their own; a wall's colour stands in place of its normal.
Raster panelRaster(const scene::DrawList& list, std::uint32_t width, std::uint32_t height) {
  Raster raster(width, height);
  for (const scene::DrawPanel& panel : list.panels) {
    std::array<RasterVertex, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = {list.relative_to_clip * glm::vec4(panel.corners[k], 1), panel.corners[k], panel.color};
    }
    raster.add(corners[0], corners[1], corners[2]);
    raster.add(corners[0], corners[2], corners[3]);
  }
  return raster;
}

void writePixel(std::uint8_t* pixel, const glm::vec3& srgb) {
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(srgb[c], 0.0f, 1.0f)));
  pixel[3] = 255;
}

// Shades the rows of one band; image rows run from the top, the raster's from the bottom.
void shadeRows(const scene::DrawList& list, const Raster& raster, const Raster& panels, unsigned band, unsigned bands,
               Image& image) {
  for (std::uint32_t y = 0; y < image.height; ++y) {
    if (y / Raster::kBand % bands != band) continue;
    const float height = (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height);
    const glm::vec3 behind = list.background_bottom + height * (list.background_top - list.background_bottom);
    std::uint8_t* row = image.row(image.height - 1 - y);
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::uint32_t id = raster.visible(x, y);
      if (id == kNothing) {
        const std::uint32_t panel = panels.visible(x, y);
        writePixel(row + std::size_t{4} * x, panel == kNothing ? behind : panels.sampleAt(panel, x, y).normal);
      } else {
        const Raster::Sample sample = raster.sampleAt(id, x, y);
        writePixel(row + std::size_t{4} * x,
                   shade(list, list.surfaces[sample.surface], sample.position, sample.normal, sample.front));
      }
    }
  }
}

class CpuRenderer final : public Renderer {
 public:
  explicit CpuRenderer(unsigned threads) : threads_(std::max(threads, 1u)) {}
  const char* name() const override { return "cpu"; }

  Result<Image> draw(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    const auto grid = sampleGrid(list.format);
    if (!grid.ok()) return grid.fault();
    Image image(list.format.width * grid.value(), list.format.height * grid.value());
    Raster raster(image.width, image.height);
    for (std::size_t i = 0; i < list.surfaces.size(); ++i) {
      raster.beginSurface(static_cast<std::uint32_t>(i), list.surfaces[i].mirrored);
      if (Status status = addSurface(list, list.surfaces[i], *sources[list.surfaces[i].source], raster); !status.ok())
        return status.fault();
    }
    Raster panels = panelRaster(list, image.width, image.height);
    // Rows of different bands share nothing, so the picture is the same for any number of threads.
    const auto drawBand = [&](unsigned band) {
      raster.resolveRows(band, threads_);
      panels.resolveRows(band, threads_);
      shadeRows(list, raster, panels, band, threads_, image);
    };
    std::vector<std::jthread> helpers;
    for (unsigned band = 1; band < threads_; ++band) helpers.emplace_back(drawBand, band);
    drawBand(0);
    helpers.clear();
    return boxFilter(image, grid.value());
  }

 private:
  Status addSurface(const scene::DrawList& list, const scene::DrawSurface& surface, const stream::Residency& source,
                    Raster& raster) {
    for (const auto items : itemsByPage(surface.items)) {
      const dyntri::PageView* page = source.resident(items.front().page);
      if (page == nullptr) return absentPage(items.front().page);
      slicer_.slice(*page, items, surface.t, surface.last_t, slice_);
      list.smooth ? addSmooth(list, surface, slice_, raster) : addFlat(list, surface, slice_, raster);
    }
    return {};
  }

  unsigned threads_;
  PageSlicer slicer_;
  PageSlice slice_;
};

}  // namespace

std::unique_ptr<Renderer> makeCpuRenderer(unsigned threads) { return std::make_unique<CpuRenderer>(threads); }

}  // namespace tet4d::render
