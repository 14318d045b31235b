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
  if (std::string_view(renderer.name()) != "cpu" || list.drawn() <= most_bytes / kBytesPerTriangle) return {};
  const std::uint64_t needed_kib = (list.drawn() * kBytesPerTriangle + 1023) / 1024;
  return Fault{FaultCode::kOutOfMemory, "", "",
               std::to_string(list.drawn()) + " triangles of a picture need " + std::to_string(needed_kib) +
                   " KiB, but " + std::to_string(most_bytes / 1024) + " KiB are left for them",
               "give more --memory, by twice the difference"};
}

// The pages of one surface at its time, brought in.
Status loadSurface(const dyntri::File& file, const scene::DrawList& list, scene::DrawSurface& surface, float t,
                   stream::PageSource& source) {
  const float last_t = file.header().last_time;
  const std::vector<std::size_t> pages = scene::choosePages(file.pages().entries(), t, last_t, list, surface);
  for (const std::size_t page : pages) {
    if (Status status = source.load(page); !status.ok()) return status;
  }
  scene::chooseTriangles(source, pages, t, last_t, surface);
  return {};
}

// One picture: scene says which pages, stream brings them, scene says which triangles, render draws.
Result<render::Image> drawFrame(const Film& film, const PictureTime& when, scene::DrawList& list,
                                std::span<stream::PageSource* const> sources, render::Renderer& renderer) {
  for (stream::PageSource* source : sources) {
    source->beginFrame();
    source->evict();  // what is kept of earlier frames fits the budget before this frame's pages come on top
  }
  for (scene::DrawSurface& surface : list.surfaces) {
    const std::size_t i = surface.source;
    if (!film.files[i].shown || !when.frames[i]) continue;
    if (Status status = loadSurface(*film.files[i].file, list, surface, *when.frames[i], *sources[i]); !status.ok())
      return status.fault();
  }
  if (Status status = checkTriangles(list, film.triangle_bytes, renderer); !status.ok()) return status.fault();
  const std::vector<const stream::Residency*> resident(sources.begin(), sources.end());
  auto image = renderer.draw(list, resident);
  for (stream::PageSource* source : sources) source->evict();
  return image;
}

}  // namespace

scene::Shot shotOfFrame(const Film& film, std::size_t i) {
  scene::Shot shot = film.shot;
  const auto frames = static_cast<double>(film.times.size());
  shot.view = scene::orbit(shot.view, film.orbit_degrees * static_cast<double>(i) / frames);
  return shot;
}

PictureTime pictureTime(std::span<const scene::SceneFile> files, double time) {
  PictureTime when{time, {}};
  for (const scene::SceneFile& file : files) when.frames.push_back(scene::frameAt(*file.file, time));
  return when;
}

Status play(const Film& film, std::span<stream::PageSource* const> sources, render::Renderer& renderer, FrameSink* sink,
            ContactSheet* sheet, const std::function<void(const FrameCost&)>& after) {
  using Clock = std::chrono::steady_clock;
  for (std::size_t i = 0; i < film.times.size(); ++i) {
    const Clock::time_point start = Clock::now();
    scene::DrawList list = scene::makeDrawList(film.files, shotOfFrame(film, i), film.format, film.smooth);
    const auto image = drawFrame(film, film.times[i], list, sources, renderer);
    if (!image.ok()) return image.fault();
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (sink != nullptr) {
      if (Status status = sink->add(image.value()); !status.ok()) return status;
    }
    if (sheet != nullptr) sheet->add(image.value());
    std::uint64_t touched = 0;
    for (const stream::PageSource* source : sources) touched += source->bytesTouched();
    after({i, ms, list.drawn(), list.processed(), touched});
  }
  return sink != nullptr ? sink->finish() : Status{};
}

}  // namespace tet4d::host
