#include "libpreprocess/measure/picture_error.h"

#include <cmath>
#include <string>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::measure {
namespace {

// The sRGB transfer function (IEC 61966-2-1) of the 256 bytes.
const std::array<float, 256>& linearOfByte() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> made{};
    for (std::size_t i = 0; i < made.size(); ++i) {
      const double c = static_cast<double>(i) / 255;
      made[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return made;
  }();
  return table;
}

std::string sizeText(const PictureView& picture) {
  return std::to_string(picture.width) + "x" + std::to_string(picture.height);
}

void requireAlike(const PictureView& a, const PictureView& b) {
  const bool alike = a.width == b.width && a.height == b.height;
  if (alike && a.width > 0 && a.height > 0 && a.rgba.size() == std::size_t{4} * a.width * a.height &&
      b.rgba.size() == a.rgba.size()) {
    return;
  }
  throw Error(FaultCode::kUsage, "", "pictures", "of " + sizeText(a) + " and " + sizeText(b) + " cannot be compared",
              "give pictures of one size");
}

// Three colours of pixel i, linear and multiplied by alpha.
std::array<float, 3> colourOf(const PictureView& picture, std::size_t i) {
  const std::array<float, 256>& linear = linearOfByte();
  const float alpha = static_cast<float>(picture.rgba[4 * i + 3]) / 255;
  return {linear[picture.rgba[4 * i]] * alpha, linear[picture.rgba[4 * i + 1]] * alpha,
          linear[picture.rgba[4 * i + 2]] * alpha};
}

}  // namespace

PictureError comparePictures(const PictureView& picture, const PictureView& reference) {
  requireAlike(picture, reference);
  PictureError error;
  CompensatedSum squares;
  const std::size_t pixels = picture.rgba.size() / 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto a = colourOf(picture, i), b = colourOf(reference, i);
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = std::abs(double{a[c]} - double{b[c]});
      squares.add(difference * difference);
      if (difference <= error.max) continue;
      error.max = difference;
      error.x = static_cast<std::uint32_t>(i % picture.width);
      error.y = static_cast<std::uint32_t>(i / picture.width);
    }
  }
  error.rmse = std::sqrt(squares.value() / (3 * static_cast<double>(pixels)));
  return error;
}

void Flicker::add(const PictureView& picture, const PictureView& reference) {
  requireAlike(picture, reference);
  const std::size_t pixels = picture.rgba.size() / 4;
  std::vector<float> now(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto a = colourOf(picture, i), b = colourOf(reference, i);
    for (std::size_t c = 0; c < 3; ++c) now[3 * i + c] = a[c] - b[c];
  }
  if (pictures_ > 0 && now.size() != last_[1].size()) {
    throw Error(FaultCode::kUsage, "", "pictures", "of a film are of several sizes", "give pictures of one size");
  }
  ++pictures_;
  if (pictures_ > 2) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double bend = std::abs(double{last_[0][i]} - 2 * double{last_[1][i]} + double{now[i]});
      squares_.add(bend * bend);
      if (bend > max_) max_ = bend;
    }
    terms_ += now.size();
  }
  last_[0] = std::move(last_[1]);
  last_[1] = std::move(now);
}

double Flicker::rms() const { return terms_ == 0 ? 0 : std::sqrt(squares_.value() / static_cast<double>(terms_)); }

}  // namespace tet4d::measure
