#include "player/host/tet_film.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "formats/core/slicer.h"
#include "formats/core/tet_slice.h"
#include "player/scene/draw_list.h"

namespace tet4d::host {
namespace {

// The pages that may have something at t.
std::vector<std::size_t> pagesAt(const hypermesh::File& file, float t, float last_t) {
  std::vector<std::size_t> pages;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const paged::PageEntry& entry = file.geometryEntry(k);
    if (entry.counts[2] > 0 && isAlive(entry.bounds.min.t, entry.bounds.max.t, t, last_t)) pages.push_back(k);
  }
  return pages;
}

// Triangles of a page's slice at t: two where it cuts between the second and the third vertex, one elsewhere.
std::uint64_t countAlive(const stream::TetPage& page, float t, float last_t) {
  std::uint64_t alive = 0;
  for (const auto& tet : page.tets) {
    std::array<float, 4> times{};
    for (std::size_t k = 0; k < 4; ++k) times[k] = page.vertices[tet[k]].t;
    std::sort(times.begin(), times.end());
    for (const DynTriRule& rule : kDynTriRules) alive += isAlive(times[rule.begin], times[rule.end], t, last_t) ? 1 : 0;
  }
  return alive;
}

}  // namespace

float lastTime(const hypermesh::File& file) { return file.header().domain.max.t; }

Status playTets(const TetFilm& film, stream::TetSource& source, render::Renderer& renderer, FrameSink* sink,
                const std::function<void(const TetFrameCost&)>& after) {
  using Clock = std::chrono::steady_clock;
  const scene::WorldBox box = scene::worldBox(film.file->header().index_to_world, film.file->header().bounds);
  const float last_t = lastTime(*film.file);
  for (std::size_t i = 0; i < film.times.size(); ++i) {
    const Clock::time_point start = Clock::now();
    scene::DrawList list = scene::makeDrawList(box, film.shot, film.format, false);
    scene::DrawSurface& surface = list.surfaces[0];
    surface.t = sliceFrame(film.times[i].frame);
    surface.last_t = last_t;
    source.beginFrame();
    TetFrameCost cost{i, 0, 0, 0, 0, 0};
    for (const std::size_t page : pagesAt(*film.file, surface.t, last_t)) {
      if (Status status = source.load(page); !status.ok()) return status;
      const std::uint64_t tets = film.file->geometryEntry(page).counts[2];
      surface.items.push_back({page, 0, tets});
      cost.tets += tets;
    }
    const std::array<const stream::Residency*, 1> sources{&source};
    const auto image = renderer.draw(list, sources);
    if (!image.ok()) return image.fault();
    cost.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (sink != nullptr) {
      if (Status status = sink->add(image.value()); !status.ok()) return status;
    }
    cost.processed = 2 * cost.tets;
    cost.bytes_touched = source.bytesTouched();
    for (const scene::DrawItem& item : surface.items) {
      if (const auto page = source.residentTets(item.page)) cost.drawn += countAlive(*page, surface.t, last_t);
    }
    after(cost);
  }
  return sink != nullptr ? sink->finish() : Status{};
}

}  // namespace tet4d::host
