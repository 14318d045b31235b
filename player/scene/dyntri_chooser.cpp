#include "player/scene/dyntri_chooser.h"

#include <algorithm>
#include <glm/vec4.hpp>

#include "formats/core/tet_slice.h"

namespace tet4d::scene {

bool isOutside(const Bounds4f& box, const DrawList& camera, const DrawSurface& surface) {
  std::array<bool, 6> all_behind;
  all_behind.fill(true);
  for (const glm::dvec3& corner : cornersOf(box)) {
    const glm::dvec3 relative = glm::dmat3(surface.index_to_relative) * (corner - glm::dvec3(surface.index_centre)) +
                                glm::dvec3(surface.offset);
    const glm::dvec4 clip = glm::dmat4(camera.relative_to_clip) * glm::dvec4(relative, 1);
    // A hair of slack, so that float rounding in a renderer never shows what was culled here.
    const double w = clip.w + 1e-5 * (std::abs(clip.w) + 1e-30);
    for (int axis = 0; axis < 3; ++axis) {
      all_behind[static_cast<std::size_t>(2 * axis)] &= clip[axis] < -w;
      all_behind[static_cast<std::size_t>(2 * axis + 1)] &= clip[axis] > w;
    }
  }
  return std::any_of(all_behind.begin(), all_behind.end(), [](bool behind) { return behind; });
}

bool isAlivePage(const paged::PageEntry& entry, float t, float last_t) {
  return entry.counts[2] != 0 && isAlive(entry.bounds.min.t, entry.bounds.max.t, t, last_t);
}

std::vector<std::size_t> choosePages(std::span<const paged::PageEntry> entries, float t, float last_t,
                                     const DrawList& camera, const DrawSurface& surface) {
  std::vector<std::size_t> chosen;
  for (std::size_t page = 0; page < entries.size(); ++page) {
    const paged::PageEntry& entry = entries[page];
    if (isAlivePage(entry, t, last_t) && !isOutside(entry.bounds, camera, surface)) chosen.push_back(page);
  }
  return chosen;
}

namespace {

using Run = std::array<std::uint64_t, 2>;  // first, one past the last

// Triangles are sorted by begin: those that begin after t are a suffix, of the others the first and the last living
// one are looked for.
Run runWithoutBands(std::span<const dyntri::Lifespan> lives, float t, float last_t) {
  const auto alive = [&](const dyntri::Lifespan& life) { return isAlive(life.begin, life.end, t, last_t); };
  const auto begun = std::upper_bound(lives.begin(), lives.end(), t,
                                      [](float time, const dyntri::Lifespan& life) { return time < life.begin; });
  const auto first = std::find_if(lives.begin(), begun, alive);
  auto last = begun;
  while (last != first && !alive(*(last - 1))) --last;
  return {static_cast<std::uint64_t>(first - lives.begin()), static_cast<std::uint64_t>(last - lives.begin())};
}

// How many are alive at t. No branches: the compiler makes vectors of it, 8 bytes a triangle go by.
std::uint64_t countAlive(std::span<const dyntri::Lifespan> lives, float t, float last_t) {
  std::uint64_t alive = 0;
  if (t == last_t) {
    for (const dyntri::Lifespan& life : lives)
      alive += static_cast<unsigned>(life.begin <= t) & static_cast<unsigned>(t <= life.end);
  } else {
    for (const dyntri::Lifespan& life : lives)
      alive += static_cast<unsigned>(life.begin <= t) & static_cast<unsigned>(t < life.end);
  }
  return alive;
}

void addRun(std::size_t page, std::span<const dyntri::Lifespan> lives, const Run& run, DrawSurface& surface) {
  const std::uint64_t count = run[1] - run[0];
  const std::uint64_t alive = countAlive(lives.subspan(run[0], count), surface.t, surface.last_t);
  if (alive == 0) return;
  surface.items.push_back({page, run[0], count});
  surface.processed += count;
  surface.drawn += alive;
}

}  // namespace

void chooseTriangles(const stream::Residency& source, std::span<const std::size_t> pages, float t, float last_t,
                     DrawSurface& surface) {
  surface.t = t;
  surface.last_t = last_t;
  surface.items.clear();
  surface.processed = surface.drawn = surface.absent = 0;
  for (const std::size_t page : pages) {
    const dyntri::PageView* view = source.resident(page);
    if (view == nullptr) {
      ++surface.absent;
      continue;
    }
    const auto [begin, end] = view->interval;
    if (view->triangles.empty() || t < begin || t > end) continue;
    if (view->bands.empty()) addRun(page, view->lifespans, runWithoutBands(view->lifespans, t, last_t), surface);
    for (const dyntri::Band& band : view->bands) addRun(page, view->lifespans, view->aliveIn(band, t), surface);
  }
}

}  // namespace tet4d::scene
