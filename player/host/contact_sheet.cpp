#include "player/host/contact_sheet.h"

#include <algorithm>

#include "player/host/png.h"

namespace tet4d::host {
namespace {

constexpr std::uint32_t kSheetWidth = 1920, kGap = 6;  // pixels

}  // namespace

ContactSheet::ContactSheet(std::size_t columns, std::size_t frames, std::size_t most)
    : columns_(std::max<std::size_t>(columns, 1)),
      frames_(frames),
      tiles_wanted_(most == 0 ? frames : std::min(most, frames)) {
  columns_ = std::min(columns_, std::max<std::size_t>(tiles_wanted_, 1));
}

std::uint32_t ContactSheet::tileWidth(std::uint32_t frame_width) const {
  const auto columns = static_cast<std::uint32_t>(columns_);
  const std::uint32_t gaps = kGap * (columns + 1);
  const std::uint32_t fitting = kSheetWidth > gaps ? (kSheetWidth - gaps) / columns : 1;
  return std::clamp(fitting, 1u, frame_width);
}

std::uint32_t ContactSheet::tileHeight(std::uint32_t frame_width, std::uint32_t frame_height) const {
  const std::uint64_t width = tileWidth(frame_width);
  const std::uint64_t height = (2 * frame_height * width + frame_width) / (std::uint64_t{2} * frame_width);
  return std::clamp(static_cast<std::uint32_t>(height), 1u, frame_height);
}

std::uint64_t ContactSheet::bytes(std::uint32_t frame_width, std::uint32_t frame_height) const {
  const std::uint64_t width = tileWidth(frame_width), height = tileHeight(frame_width, frame_height);
  const std::uint64_t rows = (tiles_wanted_ + columns_ - 1) / columns_;
  const std::uint64_t sheet_pixels = (columns_ * (width + kGap) + kGap) * (rows * (height + kGap) + kGap);
  return 4 * width * height * tiles_wanted_ + sheet_pixels * (4 + kEncodingBytes);
}

void ContactSheet::add(const render::Image& frame) {
  const std::size_t number = seen_++;
  // Tile k shows frame round(k * (frames - 1) / (tiles - 1)).
  const std::size_t k = tiles_.size();
  if (k >= tiles_wanted_) return;
  const std::size_t steps = std::max<std::size_t>(tiles_wanted_ - 1, 1);
  if (number < (2 * k * (frames_ - 1) + steps) / (2 * steps)) return;
  tiles_.push_back(render::scaleDown(frame, tileWidth(frame.width), tileHeight(frame.width, frame.height)));
}

render::Image ContactSheet::compose() const {
  if (tiles_.empty()) return {};
  const std::uint32_t width = tiles_.front().width, height = tiles_.front().height;
  const auto columns = static_cast<std::uint32_t>(columns_);
  const auto rows = static_cast<std::uint32_t>((tiles_.size() + columns_ - 1) / columns_);
  render::Image sheet(columns * width + (columns + 1) * kGap, rows * height + (rows + 1) * kGap);
  std::fill(sheet.rgba.begin(), sheet.rgba.end(), std::uint8_t{255});
  for (std::uint32_t k = 0; k < tiles_.size(); ++k) {
    const std::uint32_t left = kGap + k % columns * (width + kGap), top = kGap + k / columns * (height + kGap);
    for (std::uint32_t y = 0; y < height; ++y) {
      std::copy_n(tiles_[k].row(y), std::size_t{4} * width, sheet.row(top + y) + std::size_t{4} * left);
    }
  }
  return sheet;
}

}  // namespace tet4d::host
