// A z-buffered triangle rasterizer with OpenGL's rules: 8 bits of sub-pixel position, top-left fill, clipping to the
// view volume, depth test "less", perspective-correct weights.
//
// Two passes: visible() finds the nearest triangle of each sample, then the caller shades each sample once.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

namespace tet4d::render {

struct RasterVertex {
  glm::vec4 clip;
  glm::vec3 position;  // relative to the box's centre
  glm::vec3 normal;
  float value = 0;  // of a column
};

inline constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();

class Raster {
 public:
  // y runs up, as in OpenGL.
  Raster(std::uint32_t width, std::uint32_t height) { begin(width, height); }

  // Empties it for a new picture; memory is kept.
  void begin(std::uint32_t width, std::uint32_t height);

  // Makes room for so many triangles, so that a first picture does not move what it has gathered again and again.
  void expect(std::size_t triangles);

  // What add() brings from now on belongs to surface `number`; mirrored: its clockwise triangles are the front ones.
  void beginSurface(std::uint32_t number, bool mirrored);

  // Clips the triangle and adds what is left of it. Degenerate ones vanish.
  void add(const RasterVertex& a, const RasterVertex& b, const RasterVertex& c);

  // Resolves visibility of the rows y with y / kBand % bands == band. Calls for different bands may run in parallel.
  void resolveRows(unsigned band, unsigned bands);
  static constexpr std::uint32_t kBand = 16;

  struct Sample {
    glm::vec3 position, normal;
    float value;
    bool front;
    std::uint32_t surface;
  };
  // The id of what is seen at (x, y): kNothing, or an argument for sampleAt(). After resolveRows() of its band.
  std::uint32_t visible(std::uint32_t x, std::uint32_t y) const { return ids_[std::size_t{width_} * y + x]; }
  Sample sampleAt(std::uint32_t id, std::uint32_t x, std::uint32_t y) const;

 private:
  struct Triangle {
    std::array<std::int32_t, 3> x, y;  // 1/256 pixel, (0, 0) = centre of the first pixel; counter-clockwise
    std::array<float, 3> z;            // depth, 0..1
    std::array<std::uint32_t, 3> vertex;
    bool front;
    std::uint32_t surface;
  };
  struct Edge {
    std::int64_t dx, dy, at_origin;  // value(x, y) = at_origin + dx * x + dy * y for pixel x, y; >= 0 inside
  };
  void addClipped(const std::array<std::uint32_t, 3>& vertex);
  std::array<Edge, 3> edgesOf(const Triangle& triangle) const;
  void resolveTriangle(std::uint32_t id, unsigned band, unsigned bands);

  std::uint32_t width_ = 0, height_ = 0;
  bool mirrored_ = false;
  std::uint32_t surface_ = 0;
  std::vector<RasterVertex> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<float> depths_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace tet4d::render
