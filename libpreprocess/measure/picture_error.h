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

// Flicker of a film against its exact film: with e_k the difference of pictures k, the rms over pixels, colours and k
// of e_{k-1} - 2 e_k + e_{k+1}. An error that stays, or changes evenly, costs nothing; popping does. 0 below three
// pictures. Holds two pictures as float.
class Flicker {
 public:
  // Pictures in time order, all of one size; throws Error kUsage otherwise.
  void add(const PictureView& picture, const PictureView& reference);
  double rms() const;
  double max() const { return max_; }

 private:
  std::array<std::vector<float>, 2> last_;  // e_{k-1}, e_k
  std::size_t pictures_ = 0;
  CompensatedSum squares_;
  std::uint64_t terms_ = 0;
  double max_ = 0;
};

}  // namespace tet4d::measure
