#include "player/render/image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "player/scene/srgb.h"

namespace tet4d::render {
namespace {

std::array<float, 256> makeDecoder() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = scene::srgbToLinear(static_cast<float>(i) / 255.0f);
  return table;
}

float decode(std::uint8_t code) {
  static const std::array<float, 256> kTable = makeDecoder();
  return kTable[code];
}

std::uint8_t encode(float linear) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(scene::linearToSrgb(linear), 0.0f, 1.0f)));
}

// How much of the pixel [x, x + 1) lies in [begin, end).
double overlap(double x, double begin, double end) { return std::min(x + 1, end) - std::max(x, begin); }

}  // namespace

Image scaleDown(const Image& image, std::uint32_t width, std::uint32_t height) {
  Image out(width, height);
  const double step_x = static_cast<double>(image.width) / width, step_y = static_cast<double>(image.height) / height;
  for (std::uint32_t j = 0; j < height; ++j) {
    const double top = j * step_y, bottom = std::min((j + 1) * step_y, static_cast<double>(image.height));
    for (std::uint32_t i = 0; i < width; ++i) {
      const double left = i * step_x, right = std::min((i + 1) * step_x, static_cast<double>(image.width));
      std::array<double, 3> sum{};
      double area = 0;
      for (auto y = static_cast<std::uint32_t>(top); y < bottom; ++y) {
        for (auto x = static_cast<std::uint32_t>(left); x < right; ++x) {
          const double weight = overlap(x, left, right) * overlap(y, top, bottom);
          const std::uint8_t* pixel = image.row(y) + std::size_t{4} * x;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * static_cast<double>(decode(pixel[c]));
          area += weight;
        }
      }
      std::uint8_t* pixel = out.row(j) + std::size_t{4} * i;
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = encode(static_cast<float>(sum[c] / area));
      pixel[3] = 255;
    }
  }
  return out;
}

Image boxFilter(const Image& image, std::uint32_t side) {
  return side == 1 ? image : scaleDown(image, image.width / side, image.height / side);
}

}  // namespace tet4d::render
