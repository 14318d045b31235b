// A contact sheet: frames of a film, scaled down, in one picture, left to right and top to bottom.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "player/render/image.h"

namespace tet4d::host {

class ContactSheet {
 public:
  // columns >= 1. frames: how many the film has; most: how many tiles at most (0 = all), taken evenly, the first and
  // the last among them.
  ContactSheet(std::size_t columns, std::size_t frames, std::size_t most);
  // Frames come in order; those that are not shown are dropped at once.
  void add(const render::Image& frame);
  // The sheet; tiles on white with a gap between them. About 1920 pixels wide, never larger than the frames.
  render::Image compose() const;
  // The most that tiles, sheet and its encoding take, for frames of this size.
  std::uint64_t bytes(std::uint32_t frame_width, std::uint32_t frame_height) const;

 private:
  std::uint32_t tileWidth(std::uint32_t frame_width) const;
  std::uint32_t tileHeight(std::uint32_t frame_width, std::uint32_t frame_height) const;

  std::size_t columns_, frames_, tiles_wanted_;
  std::size_t seen_ = 0;
  std::vector<render::Image> tiles_;
};

}  // namespace tet4d::host
