#include "player/scene/pages_ahead.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "player/scene/dyntri_chooser.h"

namespace tet4d::scene {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Seconds until the time line meets the page's interval, which does not hold t.
double secondsUntil(const Bounds4f& box, double t, const Playing& playing) {
  const double speed = std::abs(playing.frames_per_s);
  if (!(speed > 0)) return kNever;
  const bool is_forward = playing.frames_per_s > 0;
  const double begin = box.min.t, end = box.max.t;
  const double distance = is_forward ? begin - t : t - end;
  if (distance >= 0) return distance / speed;
  if (!playing.loop) return kNever;
  const auto [first, last] = *playing.loop;
  // To the end of the loop, and from its other end on.
  const double around =
      is_forward ? (last - t) + std::max(begin - first, 0.0) : (t - first) + std::max(last - end, 0.0);
  return around >= 0 ? around / speed : kNever;
}

}  // namespace

std::vector<stream::Want> pagesAhead(std::span<const paged::PageEntry> entries, float t, float last_t,
                                     const Playing& playing, const DrawList& camera, const DrawSurface& surface) {
  std::vector<stream::Want> wants;
  for (const std::size_t page : choosePages(entries, t, last_t, camera, surface)) wants.push_back({page, 0});
  for (std::size_t page = 0; page < entries.size(); ++page) {
    const paged::PageEntry& entry = entries[page];
    if (entry.counts[2] == 0 || isAlivePage(entry, t, last_t)) continue;
    const double seconds = secondsUntil(entry.bounds, t, playing);
    if (!(seconds <= playing.horizon_s) || isOutside(entry.bounds, camera, surface)) continue;
    wants.push_back({page, std::max(seconds, std::numeric_limits<double>::min())});
  }
  return wants;
}

}  // namespace tet4d::scene
