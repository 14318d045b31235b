#include "player/render/raster.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace tet4d::render {
namespace {

constexpr std::int32_t kSubPixels = 256;
// Beyond this many times the view volume sideways a triangle is cut, so that fixed-point positions fit 32 bits.
constexpr float kGuardBand = 8;

// Signed distance to plane `plane` of the clipping volume; inside is >= 0.
float distanceTo(const glm::vec4& clip, int plane) {
  switch (plane) {
    case 0:
      return clip.w + clip.z;
    case 1:
      return clip.w - clip.z;
    case 2:
      return kGuardBand * clip.w + clip.x;
    case 3:
      return kGuardBand * clip.w - clip.x;
    case 4:
      return kGuardBand * clip.w + clip.y;
    default:
      return kGuardBand * clip.w - clip.y;
  }
}

RasterVertex mix(const RasterVertex& a, const RasterVertex& b, float s) {
  return {a.clip + s * (b.clip - a.clip), a.position + s * (b.position - a.position),
          a.normal + s * (b.normal - a.normal), a.value + s * (b.value - a.value)};
}

// Sutherland-Hodgman against one plane.
void clipPolygon(std::vector<RasterVertex>& polygon, std::vector<RasterVertex>& scratch, int plane) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const RasterVertex& from = polygon[i];
    const RasterVertex& to = polygon[(i + 1) % polygon.size()];
    const float d0 = distanceTo(from.clip, plane), d1 = distanceTo(to.clip, plane);
    if (d0 >= 0) scratch.push_back(from);
    if ((d0 >= 0) != (d1 >= 0)) scratch.push_back(mix(from, to, d0 / (d0 - d1)));
  }
  polygon.swap(scratch);
}

std::int32_t toFixed(float ndc, std::uint32_t size) {
  const float pixel = (ndc * 0.5f + 0.5f) * static_cast<float>(size) - 0.5f;
  return static_cast<std::int32_t>(std::lround(pixel * kSubPixels));
}

// Rounds towards minus infinity / plus infinity to whole pixels.
std::int32_t floorPixel(std::int32_t fixed) { return fixed >> 8; }
std::int32_t ceilPixel(std::int32_t fixed) { return (fixed + kSubPixels - 1) >> 8; }

}  // namespace

void Raster::begin(std::uint32_t width, std::uint32_t height) {
  width_ = width;
  height_ = height;
  vertices_.clear();
  triangles_.clear();
  depths_.assign(std::size_t{width} * height, 1.0f);
  ids_.assign(std::size_t{width} * height, kNothing);
}

void Raster::expect(std::size_t triangles) {
  vertices_.reserve(3 * triangles);
  triangles_.reserve(triangles);
}

void Raster::beginSurface(std::uint32_t number, bool mirrored) {
  surface_ = number;
  mirrored_ = mirrored;
}

void Raster::add(const RasterVertex& a, const RasterVertex& b, const RasterVertex& c) {
  const std::array<const RasterVertex*, 3> corners{&a, &b, &c};
  unsigned cut_by = 0;
  for (int plane = 0; plane < 6; ++plane) {
    unsigned outside = 0;
    for (const RasterVertex* corner : corners) outside += distanceTo(corner->clip, plane) >= 0 ? 0 : 1;
    if (outside == 3) return;
    if (outside > 0) cut_by |= 1u << plane;
  }
  const auto first = static_cast<std::uint32_t>(vertices_.size());
  if (cut_by == 0) {
    vertices_.insert(vertices_.end(), {a, b, c});
    return addClipped({first, first + 1, first + 2});
  }
  std::vector<RasterVertex> polygon{a, b, c}, scratch;
  for (int plane = 0; plane < 6; ++plane) {
    if ((cut_by & (1u << plane)) != 0) clipPolygon(polygon, scratch, plane);
  }
  if (polygon.size() < 3) return;
  vertices_.insert(vertices_.end(), polygon.begin(), polygon.end());
  for (std::uint32_t i = 1; i + 1 < polygon.size(); ++i) addClipped({first, first + i, first + i + 1});
}

void Raster::addClipped(const std::array<std::uint32_t, 3>& vertex) {
  Triangle triangle{};
  triangle.vertex = vertex;
  triangle.surface = surface_;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec4& clip = vertices_[vertex[k]].clip;
    if (!(clip.w > 0)) return;  // only the volume's apex is left of it
    triangle.x[k] = toFixed(clip.x / clip.w, width_);
    triangle.y[k] = toFixed(clip.y / clip.w, height_);
    triangle.z[k] = clip.z / clip.w * 0.5f + 0.5f;
  }
  const auto& [x, y] = std::tie(triangle.x, triangle.y);
  const std::int64_t area = std::int64_t{x[1] - x[0]} * (y[2] - y[0]) - std::int64_t{x[2] - x[0]} * (y[1] - y[0]);
  if (area == 0) return;
  triangle.front = (area > 0) != mirrored_;
  if (area < 0) {
    std::swap(triangle.x[1], triangle.x[2]);
    std::swap(triangle.y[1], triangle.y[2]);
    std::swap(triangle.z[1], triangle.z[2]);
    std::swap(triangle.vertex[1], triangle.vertex[2]);
  }
  triangles_.push_back(triangle);
}

// Edge k is opposite to corner k: its value over the area is the corner's weight. The top-left rule takes one sub-pixel
// unit off the edges that do not own the samples on them.
std::array<Raster::Edge, 3> Raster::edgesOf(const Triangle& triangle) const {
  std::array<Edge, 3> edges{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = (k + 1) % 3, to = (k + 2) % 3;
    const std::int64_t dx = triangle.x[to] - triangle.x[from], dy = triangle.y[to] - triangle.y[from];
    const std::int64_t constant = dy * triangle.x[from] - dx * triangle.y[from];
    edges[k] = {-dy * kSubPixels, dx * kSubPixels, constant};
  }
  return edges;
}

void Raster::resolveTriangle(std::uint32_t id, unsigned band, unsigned bands) {
  const Triangle& triangle = triangles_[id];
  const auto [x_low, x_high] = std::minmax({triangle.x[0], triangle.x[1], triangle.x[2]});
  const auto [y_low, y_high] = std::minmax({triangle.y[0], triangle.y[1], triangle.y[2]});
  const std::int32_t x0 = std::max(ceilPixel(x_low), 0), x1 = std::min(floorPixel(x_high), std::int32_t(width_) - 1);
  const std::int32_t y0 = std::max(ceilPixel(y_low), 0), y1 = std::min(floorPixel(y_high), std::int32_t(height_) - 1);
  if (x0 > x1 || y0 > y1) return;
  const std::array<Edge, 3> edges = edgesOf(triangle);
  const std::int64_t area = edges[0].at_origin + edges[1].at_origin + edges[2].at_origin;
  std::array<std::int64_t, 3> least{};  // an edge's smallest value that counts as inside
  for (std::size_t k = 0; k < 3; ++k) {
    const bool owns = edges[k].dx > 0 || (edges[k].dx == 0 && edges[k].dy < 0);
    least[k] = owns ? 0 : 1;
  }
  for (std::int32_t y = y0; y <= y1; ++y) {
    if (static_cast<std::uint32_t>(y) / kBand % bands != band) continue;
    std::array<std::int64_t, 3> value{};
    for (std::size_t k = 0; k < 3; ++k) value[k] = edges[k].at_origin + edges[k].dx * x0 + edges[k].dy * y;
    for (std::int32_t x = x0; x <= x1; ++x) {
      if (value[0] >= least[0] && value[1] >= least[1] && value[2] >= least[2]) {
        const float w1 = static_cast<float>(value[1]) / static_cast<float>(area);
        const float w2 = static_cast<float>(value[2]) / static_cast<float>(area);
        const float z = triangle.z[0] + w1 * (triangle.z[1] - triangle.z[0]) + w2 * (triangle.z[2] - triangle.z[0]);
        const std::size_t at = std::size_t{width_} * static_cast<std::size_t>(y) + static_cast<std::size_t>(x);
        if (z < depths_[at]) {
          depths_[at] = z;
          ids_[at] = id;
        }
      }
      for (std::size_t k = 0; k < 3; ++k) value[k] += edges[k].dx;
    }
  }
}

void Raster::resolveRows(unsigned band, unsigned bands) {
  for (std::uint32_t id = 0; id < triangles_.size(); ++id) resolveTriangle(id, band, bands);
}

Raster::Sample Raster::sampleAt(std::uint32_t id, std::uint32_t x, std::uint32_t y) const {
  const Triangle& triangle = triangles_[id];
  const std::array<Edge, 3> edges = edgesOf(triangle);
  std::array<float, 3> weight{};
  float sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t value = edges[k].at_origin + edges[k].dx * x + edges[k].dy * y;
    weight[k] = static_cast<float>(value) / vertices_[triangle.vertex[k]].clip.w;
    sum += weight[k];
  }
  Sample sample{glm::vec3(0), glm::vec3(0), 0, triangle.front, triangle.surface};
  for (std::size_t k = 0; k < 3; ++k) {
    sample.position += weight[k] / sum * vertices_[triangle.vertex[k]].position;
    sample.normal += weight[k] / sum * vertices_[triangle.vertex[k]].normal;
    sample.value += weight[k] / sum * vertices_[triangle.vertex[k]].value;
  }
  return sample;
}

}  // namespace tet4d::render
