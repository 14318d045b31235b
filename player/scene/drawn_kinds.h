// Which kinds of pictures a renderer has drawn: the first of a kind also links and translates its shaders, makes its
// buffers and lets vectors grow. What it took says nothing of those that follow.
#pragma once

#include <bitset>
#include <cstddef>

#include "player/scene/draw_list.h"

namespace tet4d::scene {

class DrawnKinds {
 public:
  // `list` is drawn now: true if it has a kind of surface that none before it had, or is the first of all.
  bool isFirst(const DrawList& list) {
    const std::bitset<kKinds> before = drawn_;
    drawn_.set(0);
    for (const DrawSurface& surface : list.surfaces) {
      if (surface.items.empty()) continue;
      const std::size_t kind = (list.smooth ? 1U : 0U) + (surface.column ? 2U : 0U) +
                               (surface.refraction > 0 ? 4U : 0U) + (surface.normal_column ? 8U : 0U);
      drawn_.set(1 + kind);
    }
    return drawn_ != before;
  }

 private:
  static constexpr std::size_t kKinds = 1 + 16;  // the background; surfaces
  std::bitset<kKinds> drawn_;
};

}  // namespace tet4d::scene
