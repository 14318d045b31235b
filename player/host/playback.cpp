#include "player/host/playback.h"

#include <chrono>
#include <vector>

namespace tet4d::host {
namespace {

// One picture: scene says which pages, stream brings them, scene says which triangles, render draws.
Result<render::Image> drawFrame(const dyntri::File& file, scene::DrawList& list, float t, stream::PageSource& source,
                                render::Renderer& renderer) {
  const float last_t = file.header().last_time;
  source.beginFrame();
  const std::vector<std::size_t> pages = scene::choosePages(file.pages().entries(), t, last_t, list);
  for (const std::size_t page : pages) {
    if (Status status = source.load(page); !status.ok()) return status.fault();
  }
  scene::chooseTriangles(source, pages, t, last_t, list);
  auto image = renderer.draw(list, source);
  source.evict();
  return image;
}

}  // namespace

Status play(const dyntri::File& file, const Film& film, stream::PageSource& source, render::Renderer& renderer,
            FrameSink* sink, ContactSheet* sheet, const std::function<void(const FrameCost&)>& after) {
  using Clock = std::chrono::steady_clock;
  const scene::WorldBox box = scene::worldBox(file.header().index_to_world, file.header().bounds);
  const auto frames = film.frame_numbers.size();
  for (std::size_t i = 0; i < frames; ++i) {
    const Clock::time_point start = Clock::now();
    scene::Shot shot = film.shot;
    shot.view = scene::orbit(shot.view, film.orbit_degrees * static_cast<double>(i) / static_cast<double>(frames));
    scene::DrawList list = scene::makeDrawList(box, shot, film.format, film.smooth);
    const auto image = drawFrame(file, list, film.frame_numbers[i], source, renderer);
    if (!image.ok()) return image.fault();
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (sink != nullptr) {
      if (Status status = sink->add(image.value()); !status.ok()) return status;
    }
    if (sheet != nullptr) sheet->add(image.value());
    after({i, ms, list.drawn, list.processed, source.bytesTouched()});
  }
  return sink != nullptr ? sink->finish() : Status{};
}

}  // namespace tet4d::host
