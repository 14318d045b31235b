// Which pages a player will need soon: those of the present time, then those that the time line is running towards.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "player/scene/draw_list.h"
#include "player/stream/pager.h"

namespace tet4d::scene {

// How time moves. All zero: it stands still, and only the present is needed.
struct Playing {
  double frames_per_s = 0;                        // of the file, negative when it plays backward
  double horizon_s = 0;                           // how far to look
  std::optional<std::pair<double, double>> loop;  // frames; at one end the time goes on at the other
};

// The pages to draw at t (as choosePages() names them) with urgency 0, and those that come into the view within the
// horizon, if the camera stays, with the seconds until then. Unordered. O(pages).
std::vector<stream::Want> pagesAhead(std::span<const paged::PageEntry> entries, float t, float last_t,
                                     const Playing& playing, const DrawList& camera, const DrawSurface& surface);

}  // namespace tet4d::scene
