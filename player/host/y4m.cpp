#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "player/host/film.h"
#include "player/host/output_file.h"

namespace tet4d::host {
namespace {

std::byte toByte(double value) { return static_cast<std::byte>(std::lround(std::clamp(value, 0.0, 255.0))); }

// BT.601, limited range; r, g, b in 0..255.
std::byte lumaOf(double r, double g, double b) { return toByte(16 + (65.481 * r + 128.553 * g + 24.966 * b) / 255); }
std::byte blueOf(double r, double g, double b) { return toByte(128 + (-37.797 * r - 74.203 * g + 112.0 * b) / 255); }
std::byte redOf(double r, double g, double b) { return toByte(128 + (112.0 * r - 93.786 * g - 18.214 * b) / 255); }

// The mean of the (up to) 2x2 pixels that share a chroma sample.
std::array<double, 3> blockMean(const render::Image& image, std::uint32_t x, std::uint32_t y) {
  std::array<double, 3> sum{};
  double count = 0;
  for (std::uint32_t j = y; j < std::min(y + 2, image.height); ++j) {
    for (std::uint32_t i = x; i < std::min(x + 2, image.width); ++i) {
      const std::uint8_t* pixel = image.row(j) + std::size_t{4} * i;
      for (std::size_t c = 0; c < 3; ++c) sum[c] += pixel[c];
      ++count;
    }
  }
  for (double& value : sum) value /= count;
  return sum;
}

void appendPlanes(const render::Image& image, std::vector<std::byte>& out) {
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const std::uint8_t* row = image.row(y);
    for (std::uint32_t x = 0; x < image.width; ++x) out.push_back(lumaOf(row[4 * x], row[4 * x + 1], row[4 * x + 2]));
  }
  for (const auto plane : {blueOf, redOf}) {
    for (std::uint32_t y = 0; y < image.height; y += 2) {
      for (std::uint32_t x = 0; x < image.width; x += 2) {
        const auto [r, g, b] = blockMean(image, x, y);
        out.push_back(plane(r, g, b));
      }
    }
  }
}

class Y4mFilm final : public FrameSink {
 public:
  Y4mFilm(OutputFile file, double fps) : file_(std::move(file)), fps_(fps) {}

  Status add(const render::Image& image) override {
    std::vector<std::byte> bytes;
    if (frames_++ == 0) append(header(image), bytes);
    append("FRAME\n", bytes);
    appendPlanes(image, bytes);
    return file_.write(bytes);
  }
  Status finish() override { return file_.commit(); }

 private:
  static void append(const std::string& text, std::vector<std::byte>& bytes) {
    for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  }
  std::string header(const render::Image& image) const {
    const std::int64_t frames = std::max<std::int64_t>(std::llround(fps_ * 1000), 1);
    const std::int64_t divisor = std::gcd(frames, std::int64_t{1000});
    return "YUV4MPEG2 W" + std::to_string(image.width) + " H" + std::to_string(image.height) + " F" +
           std::to_string(frames / divisor) + ":" + std::to_string(1000 / divisor) +
           " Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n";
  }

  OutputFile file_;
  double fps_;
  std::uint64_t frames_ = 0;
};

}  // namespace

Result<std::unique_ptr<FrameSink>> makeY4mFilm(const std::string& path, double fps, bool force) {
  if (!(fps >= 0.001 && fps <= 1e6)) {
    return Fault{FaultCode::kUsage, path, "fps", "not between 0.001 and 1e6 pictures a second", "give --fps 25"};
  }
  auto file = OutputFile::create(path, force);
  if (!file.ok()) return file.fault();
  return std::unique_ptr<FrameSink>(std::make_unique<Y4mFilm>(std::move(file).value(), fps));
}

}  // namespace tet4d::host
