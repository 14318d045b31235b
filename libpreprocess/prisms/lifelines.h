// Which vertices a window keeps at which frames: all where motion bends, the ends where it is straight.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/prisms/surface_edges.h"
#include "libpreprocess/prisms/window.h"

namespace tet4d::prisms {

// Chooses so few frames that at every frame of the window the slice of the staircases lies within `tolerance` (world
// units) of the input, point by point. From the window's ends on, a frame is kept between two kept ones where a
// lifeline bends too far, or a diagonal of a wall passes too far off: then at both ends of it. Neighbours come to the
// same frames, the roundest numbers, so that diagonals stay short. used[v]: whether v is in a triangle. The same for
// any number of threads. A sweep over what changed takes O(steps) a vertex and an edge; there are a few more than
// log2(steps) as a rule, and never more than vertices * steps.
std::vector<Kept> fitLifelines(const Window& window, std::span<const Edge> edges, std::span<const std::uint8_t> used,
                               const WorldLength& length, double tolerance, outofcore::Executor& executor);

}  // namespace tet4d::prisms
