// How far pictures are from the exact ones: in space (RMSE) and in time (flicker).
//
// Pictures are 8-bit sRGB with straight alpha. They are compared in linear light, colours multiplied by alpha, in units
// of the full range: 1/255 is one step of a byte near white.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/measure/compensated_sum.h"

namespace tet4d::measure {

struct PictureView {
  std::uint32_t width = 0, height = 0;
  std::span<const std::uint8_t> rgba;  // 4 * width * height bytes, rows from the top
};

struct PictureError {
  double rmse = 0;             // over pixels and the three colours
  double max = 0;              // of a colour of a pixel
  std::uint32_t x = 0, y = 0;  // the first pixel that has it
};

// Both of one size, at least a pixel; throws Error kUsage otherwise. O(pixels).
PictureError comparePictures(const PictureView& picture, const PictureView& reference);

// The same row by row, for pictures of any size.
class PictureMeter {
 public:
  // 4 * width bytes each, the same width for every row; throws Error kUsage otherwise.
  void addRow(std::span<const std::uint8_t> row, std::span<const std::uint8_t> reference);
  PictureError result() const;

 private:
  PictureError error_;
  CompensatedSum squares_;
  std::size_t width_ = 0;
  std::uint32_t rows_ = 0;
};

// A film against its exact film, row by row: the error of all pictures, and flicker. With e_k the difference of
// pictures k, flicker is the rms over pixels, colours and k of e_{k-1} - 2 e_k + e_{k+1}. An error that stays, or
// changes evenly, costs nothing; popping does. 0 below three pictures. Memory: a row of floats a picture.
class FilmMeter {
 public:
  using Row = std::span<const std::uint8_t>;
  // The same row of all pictures in time order, and of the exact ones, 4 * width bytes each. counted: the first so many
  // (0 or 2) were the last of an earlier part of the film: they serve the flicker and are not counted again.
  void addRow(std::span<const Row> pictures, std::span<const Row> references, std::size_t counted = 0);
  double rmse() const;
  double max() const { return max_; }
  double flicker() const;
  double flickerMax() const { return flicker_max_; }

 private:
  void addBends(std::size_t pictures);

  std::vector<std::vector<float>> errors_;  // of this row, a picture each
  CompensatedSum squares_, bends_;
  std::uint64_t terms_ = 0, bend_terms_ = 0;
  double max_ = 0, flicker_max_ = 0;
};

}  // namespace tet4d::measure
