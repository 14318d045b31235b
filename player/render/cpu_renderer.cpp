#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <thread>

#include "player/render/page_slice.h"
#include "player/render/phong.h"
#include "player/render/raster.h"
#include "player/render/renderer.h"
#include "player/render/slice_columns.h"

namespace tet4d::render {
namespace {

glm::vec3 toGlm(const Vec3f& v) { return {v.x, v.y, v.z}; }

glm::vec3 unitOrZero(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

RasterVertex project(const scene::DrawList& list, const scene::DrawSurface& surface, const Vec3f& index) {
  const glm::vec3 relative = surface.index_to_relative * (toGlm(index) - surface.index_centre) + surface.offset;
  return {list.relative_to_clip * glm::vec4(relative, 1), relative, glm::vec3(0), 0};
}

// A slice's vertices in the view, with their values and, if smooth, normals.
std::vector<RasterVertex> verticesOf(const scene::DrawList& list, const scene::DrawSurface& surface,
                                     const dyntri::PageView& page, const stream::Residency& source, std::size_t number,
                                     const PageSlice& slice) {
  std::vector<RasterVertex> vertices(slice.positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = project(list, surface, slice.positions[i]);
  const auto normals =
      surface.normal_column ? source.residentColumn(number, *surface.normal_column) : std::span<const float>{};
  if (list.smooth && normals.size() >= 3 * page.vertices.size()) {
    const std::vector<Vec3f> of_file = sliceVectors(page, slice.keys, surface.t, normals);
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i].normal = unitOrZero(toGlm(of_file[i]));
  } else if (list.smooth) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      vertices[i].normal = unitOrZero(surface.normal_to_relative * toGlm(slice.areas[i]));
  }
  if (surface.column && surface.column->of_parts) {
    for (RasterVertex& vertex : vertices) vertex.value = scene::partValue(page.part);
  } else if (surface.column) {
    const std::vector<float> values = sliceValues(page, slice.keys, surface.t, *surface.column,
                                                  source.residentColumn(number, surface.column->column));
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i].value = values[i];
  }
  return vertices;
}

void addFlat(const scene::DrawSurface& surface, const PageSlice& slice, std::span<const RasterVertex> vertices,
             Raster& raster) {
  for (const auto& triangle : slice.triangles) {
    const glm::vec3 origin = toGlm(slice.positions[triangle[0]]);
    const glm::vec3 area =
        glm::cross(toGlm(slice.positions[triangle[1]]) - origin, toGlm(slice.positions[triangle[2]]) - origin);
    const glm::vec3 normal = unitOrZero(surface.normal_to_relative * area);
    std::array<RasterVertex, 3> corners{vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]};
    for (RasterVertex& corner : corners) corner.normal = normal;
    raster.add(corners[0], corners[1], corners[2]);
  }
}

void writePixel(std::uint8_t* pixel, const glm::vec3& srgb) {
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(srgb[c], 0.0f, 1.0f)));
  pixel[3] = 255;
}

glm::vec3 panelColor(const scene::DrawPanel& panel, const glm::vec3& place) {
  const glm::vec2 square = glm::floor(glm::vec2(place) * panel.squares);
  const bool dark = std::fmod(square.x + square.y, 2.0f) == 1;
  return dark ? scene::kCheckerShade * panel.color : panel.color;
}

// Calls work(band, bands) for every band, each on a thread. What the bands write must not overlap.
template <class Work>
void inBands(unsigned bands, const Work& work) {
  std::vector<std::jthread> helpers;
  for (unsigned band = 1; band < bands; ++band) helpers.emplace_back([&work, band, bands] { work(band, bands); });
  work(0, bands);
}

// Gradient and walls, kept for as long as camera, colours and size stay.
class Background {
 public:
  const Image& of(const scene::DrawList& list, std::uint32_t width, std::uint32_t height, unsigned threads) {
    if (image_.width != width || image_.height != height || !isSame(list)) {
      list_ = list;
      list_.surfaces.clear();
      draw(width, height, threads);
    }
    return image_;
  }

 private:
  bool isSame(const scene::DrawList& list) const {
    return list.relative_to_clip == list_.relative_to_clip && list.background_top == list_.background_top &&
           list.background_bottom == list_.background_bottom &&
           std::equal(list.panels.begin(), list.panels.end(), list_.panels.begin(), list_.panels.end(),
                      [](const scene::DrawPanel& a, const scene::DrawPanel& b) {
                        return a.corners == b.corners && a.color == b.color && a.squares == b.squares;
                      });
  }

  // The place on a wall stands for its position.
  void draw(std::uint32_t width, std::uint32_t height, unsigned threads) {
    image_ = Image(width, height);
    Raster raster(width, height);
    for (std::size_t i = 0; i < list_.panels.size(); ++i) {
      constexpr std::array<glm::vec3, 4> kPlaces{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
      std::array<RasterVertex, 4> corners{};
      for (std::size_t k = 0; k < 4; ++k)
        corners[k] = {list_.relative_to_clip * glm::vec4(list_.panels[i].corners[k], 1), kPlaces[k], glm::vec3(0)};
      raster.beginSurface(static_cast<std::uint32_t>(i), false);
      raster.add(corners[0], corners[1], corners[2]);
      raster.add(corners[0], corners[2], corners[3]);
    }
    inBands(threads, [&](unsigned band, unsigned bands) {
      raster.resolveRows(band, bands);
      writeRows(raster, band, bands);
    });
  }

  // Image rows run from the top, the raster's from the bottom.
  void writeRows(const Raster& raster, unsigned band, unsigned bands) {
    for (std::uint32_t y = 0; y < image_.height; ++y) {
      if (y / Raster::kBand % bands != band) continue;
      const float height = (static_cast<float>(y) + 0.5f) / static_cast<float>(image_.height);
      const glm::vec3 gradient = list_.background_bottom + height * (list_.background_top - list_.background_bottom);
      std::uint8_t* row = image_.row(image_.height - 1 - y);
      for (std::uint32_t x = 0; x < image_.width; ++x) {
        const std::uint32_t id = raster.visible(x, y);
        if (id == kNothing) {
          writePixel(row + std::size_t{4} * x, gradient);
        } else {
          const Raster::Sample sample = raster.sampleAt(id, x, y);
          writePixel(row + std::size_t{4} * x, panelColor(list_.panels[sample.surface], sample.position));
        }
      }
    }
  }

  scene::DrawList list_;
  Image image_;
};

// The rows of one band: every visible sample of a surface is shaded once, the rest is background.
void shadeRows(const scene::DrawList& list, const Raster& raster, const Image& behind, unsigned band, unsigned bands,
               Image& image) {
  for (std::uint32_t y = 0; y < image.height; ++y) {
    if (y / Raster::kBand % bands != band) continue;
    std::uint8_t* row = image.row(image.height - 1 - y);
    std::copy_n(behind.row(image.height - 1 - y), std::size_t{4} * image.width, row);
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::uint32_t id = raster.visible(x, y);
      if (id == kNothing) continue;
      const Raster::Sample sample = raster.sampleAt(id, x, y);
      const glm::vec2 place(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const glm::vec3 light = shade(list, list.surfaces[sample.surface],
                                    {sample.position, sample.normal, sample.value, sample.front, place}, behind);
      for (int c = 0; c < 3; ++c) row[std::size_t{4} * x + static_cast<std::size_t>(c)] = toSrgb8(light[c]);
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
    const Image& behind = background_.of(list, image.width, image.height, threads_);
    raster_.begin(image.width, image.height);
    raster_.expect(list.drawn());
    for (std::size_t i = 0; i < list.surfaces.size(); ++i) {
      raster_.beginSurface(static_cast<std::uint32_t>(i), list.surfaces[i].mirrored);
      if (Status status = addSurface(list, list.surfaces[i], *sources[list.surfaces[i].source]); !status.ok())
        return status.fault();
    }
    // Rows of different bands share nothing, so the picture is the same for any number of threads.
    inBands(threads_, [&](unsigned band, unsigned bands) {
      raster_.resolveRows(band, bands);
      shadeRows(list, raster_, behind, band, bands, image);
    });
    return boxFilter(image, grid.value());
  }

 private:
  Status addSurface(const scene::DrawList& list, const scene::DrawSurface& surface, const stream::Residency& source) {
    for (const auto items : itemsByPage(surface.items)) {
      const std::size_t number = items.front().page;
      const dyntri::PageView* page = source.resident(number);
      if (page == nullptr) return absentPage(number);
      slicer_.slice(*page, items, surface.t, surface.last_t, slice_);
      const std::vector<RasterVertex> vertices = verticesOf(list, surface, *page, source, number, slice_);
      if (!list.smooth) {
        addFlat(surface, slice_, vertices, raster_);
        continue;
      }
      for (const auto& [a, b, c] : slice_.triangles) raster_.add(vertices[a], vertices[b], vertices[c]);
    }
    return {};
  }

  unsigned threads_;
  PageSlicer slicer_;
  PageSlice slice_;
  Background background_;
  Raster raster_{1, 1};
};

}  // namespace

std::unique_ptr<Renderer> makeCpuRenderer(unsigned threads) { return std::make_unique<CpuRenderer>(threads); }

}  // namespace tet4d::render
