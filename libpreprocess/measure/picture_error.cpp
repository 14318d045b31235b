#include "libpreprocess/measure/picture_error.h"

#include <algorithm>
#include <cmath>
#include <string>

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

[[noreturn]] void failSizes() {
  throw Error(FaultCode::kUsage, "", "pictures", "of a film are of several sizes", "give pictures of one size");
}

// Three colours of pixel i, linear and multiplied by alpha.
std::array<float, 3> colourOf(std::span<const std::uint8_t> rgba, std::size_t i) {
  const std::array<float, 256>& linear = linearOfByte();
  const float alpha = static_cast<float>(rgba[4 * i + 3]) / 255;
  return {linear[rgba[4 * i]] * alpha, linear[rgba[4 * i + 1]] * alpha, linear[rgba[4 * i + 2]] * alpha};
}

double rootMean(const CompensatedSum& squares, std::uint64_t terms) {
  return terms == 0 ? 0 : std::sqrt(squares.value() / static_cast<double>(terms));
}

}  // namespace

PictureError comparePictures(const PictureView& picture, const PictureView& reference) {
  requireAlike(picture, reference);
  PictureMeter meter;
  const std::size_t row = std::size_t{4} * picture.width;
  for (std::size_t y = 0; y < picture.height; ++y)
    meter.addRow(picture.rgba.subspan(y * row, row), reference.rgba.subspan(y * row, row));
  return meter.result();
}

void PictureMeter::addRow(std::span<const std::uint8_t> row, std::span<const std::uint8_t> reference) {
  if (row.size() != reference.size() || row.size() % 4 != 0 || (rows_ > 0 && row.size() != 4 * width_)) failSizes();
  width_ = row.size() / 4;
  for (std::size_t i = 0; i < width_; ++i) {
    const auto a = colourOf(row, i), b = colourOf(reference, i);
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = std::abs(double{a[c]} - double{b[c]});
      squares_.add(difference * difference);
      if (difference <= error_.max) continue;
      error_.max = difference;
      error_.x = static_cast<std::uint32_t>(i);
      error_.y = rows_;
    }
  }
  ++rows_;
}

PictureError PictureMeter::result() const {
  PictureError error = error_;
  error.rmse = rootMean(squares_, std::uint64_t{3} * width_ * rows_);
  return error;
}

void FilmMeter::addRow(std::span<const Row> pictures, std::span<const Row> references, std::size_t counted) {
  if (pictures.size() != references.size()) failSizes();
  errors_.resize(pictures.size());
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (pictures[k].size() != references[k].size() || pictures[k].size() != pictures[0].size()) failSizes();
    const std::size_t pixels = pictures[k].size() / 4;
    errors_[k].resize(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      const auto a = colourOf(pictures[k], i), b = colourOf(references[k], i);
      for (std::size_t c = 0; c < 3; ++c) errors_[k][3 * i + c] = a[c] - b[c];
    }
    if (k < counted) continue;
    for (const float error : errors_[k]) {
      squares_.add(double{error} * double{error});
      max_ = std::max(max_, std::abs(double{error}));
    }
    terms_ += errors_[k].size();
  }
  addBends(pictures.size());
}

void FilmMeter::addBends(std::size_t pictures) {
  for (std::size_t k = 1; k + 1 < pictures; ++k) {
    for (std::size_t i = 0; i < errors_[k].size(); ++i) {
      const double bend = std::abs(double{errors_[k - 1][i]} - 2 * double{errors_[k][i]} + double{errors_[k + 1][i]});
      bends_.add(bend * bend);
      flicker_max_ = std::max(flicker_max_, bend);
    }
    bend_terms_ += errors_[k].size();
  }
}

double FilmMeter::rmse() const { return rootMean(squares_, terms_); }
double FilmMeter::flicker() const { return rootMean(bends_, bend_terms_); }

}  // namespace tet4d::measure
