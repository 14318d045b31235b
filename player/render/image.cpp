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

const std::array<float, 256> kDecoder = makeDecoder();

float decode(std::uint8_t code) { return kDecoder[code]; }

std::uint8_t encode(float linear) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(scene::linearToSrgb(linear), 0.0f, 1.0f)));
}

// encode() by table, for pictures: fine enough that every code keeps its own steps, even near black.
constexpr float kEncoderSteps = 65535;

std::vector<std::uint8_t> makeEncoder() {
  std::vector<std::uint8_t> table(65536);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = encode(static_cast<float>(i) / kEncoderSteps);
  return table;
}

std::uint8_t encodeStep(float linear_steps) {
  static const std::vector<std::uint8_t> kTable = makeEncoder();
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative, and a call for every channel of every sample
  return kTable[std::min(static_cast<std::size_t>(linear_steps + 0.5f), kTable.size() - 1)];
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

std::uint8_t toSrgb8(float linear) { return encodeStep(kEncoderSteps * std::max(linear, 0.0f)); }

float fromSrgb8(std::uint8_t code) { return kDecoder[code]; }

Image boxFilter(const Image& image, std::uint32_t side) {
  if (side == 1) return image;
  Image out(image.width / side, image.height / side);
  const float weight = kEncoderSteps / static_cast<float>(side * side);
  std::vector<float> sums(std::size_t{3} * out.width);
  for (std::uint32_t j = 0; j < out.height; ++j) {
    std::fill(sums.begin(), sums.end(), 0.0f);
    for (std::uint32_t y = j * side; y < (j + 1) * side; ++y) {
      const std::uint8_t* pixel = image.row(y);
      for (std::size_t i = 0; i < sums.size(); i += 3) {
        for (std::uint32_t k = 0; k < side; ++k, pixel += 4) {
          for (std::size_t c = 0; c < 3; ++c) sums[i + c] += decode(pixel[c]);
        }
      }
    }
    std::uint8_t* pixel = out.row(j);
    for (std::size_t i = 0; i < sums.size(); i += 3, pixel += 4) {
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = encodeStep(sums[i + c] * weight);
      pixel[3] = 255;
    }
  }
  return out;
}

Image scaleUp(const Image& image, std::uint32_t width, std::uint32_t height) {
  Image large(width, height);
  for (std::uint32_t y = 0; y < height; ++y) {
    const std::uint8_t* from = image.row(static_cast<std::uint32_t>(std::uint64_t{y} * image.height / height));
    std::uint8_t* to = large.row(y);
    for (std::uint32_t x = 0; x < width; ++x)
      std::copy_n(from + 4 * (std::uint64_t{x} * image.width / width), 4, to + std::size_t{4} * x);
  }
  return large;
}

}  // namespace tet4d::render
