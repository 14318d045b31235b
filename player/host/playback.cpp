#include "player/host/playback.h"

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace tet4d::host {
namespace {

// A living triangle in the plain C++ renderer: 36 bytes sliced, 120 as corners, 64 set up; vectors that grow hold up to
// three times that for a moment.
constexpr std::uint64_t kBytesPerTriangle = 3 * (36 + 120 + 64);

Status checkTriangles(const scene::DrawList& list, std::uint64_t most_bytes, const render::Renderer& renderer) {
  if (std::string_view(renderer.name()) != "cpu" || list.drawn <= most_bytes / kBytesPerTriangle) return {};
  const std::uint64_t needed_kib = (list.drawn * kBytesPerTriangle + 1023) / 1024;
  return Fault{FaultCode::kOutOfMemory, "", "",
               std::to_string(list.drawn) + " triangles of a picture need " + std::to_string(needed_kib) +
                   " KiB, but " + std::to_string(most_bytes / 1024) + " KiB are left for them",
               "give more --memory, by twice the difference"};
}

// One picture: scene says which pages, stream brings them, scene says which triangles, render draws.
Result<render::Image> drawFrame(const dyntri::File& file, scene::DrawList& list, float t, std::uint64_t triangle_bytes,
                                stream::PageSource& source, render::Renderer& renderer) {
  const float last_t = file.header().last_time;
  source.beginFrame();
  source.evict();  // what is kept of earlier frames fits the budget before this frame's pages come on top
  const std::vector<std::size_t> pages = scene::choosePages(file.pages().entries(), t, last_t, list);
  for (const std::size_t page : pages) {
    if (Status status = source.load(page); !status.ok()) return status.fault();
  }
  scene::chooseTriangles(source, pages, t, last_t, list);
  if (Status status = checkTriangles(list, triangle_bytes, renderer); !status.ok()) return status.fault();
  auto image = renderer.draw(list, source);
  source.evict();
  return image;
}

}  // namespace

scene::Shot shotOfFrame(const Film& film, std::size_t i) {
  scene::Shot shot = film.shot;
  const auto frames = static_cast<double>(film.frame_numbers.size());
  shot.view = scene::orbit(shot.view, film.orbit_degrees * static_cast<double>(i) / frames);
  return shot;
}

Status play(const dyntri::File& file, const Film& film, stream::PageSource& source, render::Renderer& renderer,
            FrameSink* sink, ContactSheet* sheet, const std::function<void(const FrameCost&)>& after) {
  using Clock = std::chrono::steady_clock;
  const scene::WorldBox box = scene::worldBox(file.header().index_to_world, file.header().bounds);
  const auto frames = film.frame_numbers.size();
  for (std::size_t i = 0; i < frames; ++i) {
    const Clock::time_point start = Clock::now();
    scene::DrawList list = scene::makeDrawList(box, shotOfFrame(film, i), film.format, film.smooth);
    const auto image = drawFrame(file, list, film.frame_numbers[i], film.triangle_bytes, source, renderer);
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
