// A picture: 8 bits a channel, sRGB, opaque, rows from the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tet4d::render {

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4 * width * height bytes

  Image() = default;
  Image(std::uint32_t w, std::uint32_t h) : width(w), height(h), rgba(std::size_t{4} * w * h) {}
  std::uint8_t* row(std::uint32_t y) { return rgba.data() + std::size_t{4} * width * y; }
  const std::uint8_t* row(std::uint32_t y) const { return rgba.data() + std::size_t{4} * width * y; }
};

// A channel of the picture from linear light (clamped to 0..1) and back, by tables.
std::uint8_t toSrgb8(float linear);
float fromSrgb8(std::uint8_t code);

// Averages blocks of side x side pixels in linear light. width and height must be multiples of side.
Image boxFilter(const Image& image, std::uint32_t side);

// Scales down to width x height (each at most the image's) by area weights in linear light.
Image scaleDown(const Image& image, std::uint32_t width, std::uint32_t height);

// Scales up to width x height (each at least the image's) by repeating pixels.
Image scaleUp(const Image& image, std::uint32_t width, std::uint32_t height);

}  // namespace tet4d::render
