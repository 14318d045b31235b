#include "player/host/playback.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "player/host/foresight.h"
#include "player/scene/drawn_kinds.h"

namespace tet4d::host {
namespace {

// A living triangle in the plain C++ renderer: 64 bytes sliced, 132 as corners, 64 set up; vectors that grow hold up to
// three times that for a moment.
constexpr std::uint64_t kBytesPerTriangle = 3 * (64 + 132 + 64);

Status checkTriangles(const scene::DrawList& list, std::uint64_t most_bytes, const render::Renderer& renderer) {
  if (std::string_view(renderer.name()) != "cpu" || list.drawn() <= most_bytes / kBytesPerTriangle) return {};
  const std::uint64_t needed_kib = (list.drawn() * kBytesPerTriangle + 1023) / 1024;
  return Fault{FaultCode::kOutOfMemory, "", "",
               std::to_string(list.drawn()) + " triangles of a picture need " + std::to_string(needed_kib) +
                   " KiB, but " + std::to_string(most_bytes / 1024) + " KiB are left for them",
               "give more --memory, by twice the difference"};
}

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Asks for the pages of the picture and of those to come; waits for the picture's unless the film draws what is there.
Status load(const Film& film, const Foresight& foresight, const Foresight::Picture& picture,
            std::span<stream::Pager* const> pagers) {
  for (std::size_t file = 0; file < pagers.size(); ++file) {
    pagers[file]->beginFrame();
    pagers[file]->want(foresight.wants(file));
  }
  for (std::size_t file = 0; file < pagers.size(); ++file) {
    if (film.arrival == Arrival::kWait) pagers[file]->waitFor(picture.pages[file]);
    for (const std::size_t page : picture.pages[file]) {
      const Fault* fault = pagers[file]->faultOf(page);
      // Memory that is not there is no damage: without it the film cannot be what was asked for.
      if (fault != nullptr && (!film.skip_damaged || fault->code == FaultCode::kOutOfMemory)) return *fault;
    }
  }
  return {};
}

void choose(const Film& film, const PictureTime& when, const Foresight::Picture& picture,
            std::span<stream::Pager* const> pagers, scene::DrawList& list) {
  for (scene::DrawSurface& surface : list.surfaces) {
    const std::size_t file = surface.source;
    if (!film.files[file].shown || !when.frames[file]) continue;
    scene::chooseTriangles(*pagers[file], picture.pages[file], *when.frames[file],
                           film.files[file].file->header().last_time, surface);
  }
}

// What a budget can do before there are levels of detail: the picture's samples and its size.
class Economy {
 public:
  explicit Economy(const Film& film)
      : film_(&film),
        budget_(film.budget_ms),
        quality_(film.format.samples),
        pixels_(static_cast<double>(film.format.width) * film.format.height) {}

  // The format to draw picture i with, which hands over `primitives`.
  scene::Format formatOf(std::size_t i, double primitives) {
    const bool is_moving = i > 0 && (film_->times[i].time != film_->times[i - 1].time || film_->orbit_degrees != 0);
    const scene::Quality quality = quality_.next(budget_, pixels_, primitives, 0, is_moving);
    scene::Format format = film_->format;
    format.samples = quality.samples;
    format.width = std::max(format.width / quality.divide, 1u);
    format.height = std::max(format.height / quality.divide, 1u);
    return format;
  }
  // The list of a picture that is begun: what is first of its kind is not learnt from.
  bool isFirst(const scene::DrawList& list) { return kinds_.isFirst(list); }
  void learn(const FrameCost& cost) {
    const auto bytes = static_cast<double>(cost.bytes_touched);
    budget_.add({static_cast<double>(cost.processed), bytes, cost.samples * pixels_}, cost.ms);
  }
  // Samples a pixel of the film's own size.
  double samplesOf(const scene::Format& format) const {
    return static_cast<double>(format.width) * format.height * format.samples / pixels_;
  }
  BudgetReport report() const { return budget_.report(); }

 private:
  const Film* film_;
  scene::DrawnKinds kinds_;
  scene::FrameBudget budget_;
  scene::MotionQuality quality_;
  double pixels_;
};

// A picture that the renderer has begun.
struct Started {
  FrameCost cost{};
  scene::Format format;
  bool is_first = false;  // of its kind
};

// One picture: scene says which pages, stream brings them, scene says which triangles, render draws.
Status startFrame(const Film& film, std::size_t i, Foresight& foresight, Economy& economy,
                  std::span<stream::Pager* const> pagers, render::Renderer& renderer, Started& started) {
  FrameCost& cost = started.cost;
  cost.index = i;
  const Clock::time_point start = Clock::now();
  const Foresight::Picture& picture = foresight.advance(i);
  const double camera_ms = msSince(start);
  if (Status status = load(film, foresight, picture, pagers); !status.ok()) return status;
  cost.load_ms = msSince(start) - camera_ms;
  scene::DrawList list = picture.list;
  choose(film, film.times[i], picture, pagers, list);
  if (Status status = checkTriangles(list, film.triangle_bytes, renderer); !status.ok()) return status;
  cost.choose_ms = msSince(start) - cost.load_ms;
  const std::vector<const stream::Residency*> resident(pagers.begin(), pagers.end());
  list.format = started.format = economy.formatOf(i, static_cast<double>(list.processed()));
  started.is_first = economy.isFirst(list);
  if (Status status = renderer.start(list, resident); !status.ok()) return status;
  cost.samples = economy.samplesOf(list.format);
  cost.ms = msSince(start);
  cost.drawn = list.drawn();
  cost.processed = list.processed();
  cost.absent = list.absent();
  for (const stream::Pager* pager : pagers) {
    cost.bytes_touched += pager->frameReads().touched;
    cost.prefetched += pager->frameReads().prefetched;
  }
  return {};
}

// The picture begun first, at the film's size.
Result<render::Image> takeFrame(const Film& film, Economy& economy, render::Renderer& renderer, Started& started) {
  const Clock::time_point start = Clock::now();
  auto image = renderer.take();
  if (!image.ok()) return image.fault();
  if (started.format.width != film.format.width || started.format.height != film.format.height)
    image = render::scaleUp(image.value(), film.format.width, film.format.height);
  FrameCost& cost = started.cost;
  cost.ms += msSince(start);
  cost.draw_ms = cost.ms - cost.choose_ms - cost.load_ms;
  if (!started.is_first) economy.learn(cost);
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

Status play(const Film& film, std::span<stream::Pager* const> pagers, render::Renderer& renderer, FrameSink* sink,
            ContactSheet* sheet, const std::function<void(const FrameCost&)>& after, BudgetReport* report) {
  Foresight foresight(film);
  Economy economy(film);
  for (std::size_t file = 0; file < pagers.size(); ++file) pagers[file]->useColumns(scene::columnsOf(film.files[file]));
  // At a pace every picture is wanted as soon as it can be; an exact film has time to draw the next one meanwhile.
  const std::size_t ahead = film.arrival == Arrival::kWait ? renderer.picturesAhead() : 0;
  std::deque<Started> started;
  const auto takeOne = [&]() -> Status {
    auto image = takeFrame(film, economy, renderer, started.front());
    if (!image.ok()) return image.fault();
    drawLegends(image.value(), film.legends, {0, 0, double{1} * film.format.width, double{1} * film.format.height},
                legendLine(film.format.width, film.format.height), isDark(film.shot.background));
    if (sink != nullptr) {
      if (Status status = sink->add(image.value()); !status.ok()) return status;
    }
    if (sheet != nullptr) sheet->add(image.value());
    if (report != nullptr) *report = economy.report();
    after(started.front().cost);
    started.pop_front();
    return {};
  };
  const auto takeAll = [&]() -> Status {
    while (!started.empty()) {
      if (Status status = takeOne(); !status.ok()) return status;
    }
    return {};
  };
  Clock::time_point due = Clock::now();
  for (std::size_t i = 0; i < film.times.size(); ++i) {
    if (film.arrival == Arrival::kDraw) {
      std::this_thread::sleep_until(due);
      due = std::max(due, Clock::now()) +
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / film.fps));
    }
    started.emplace_back();
    if (Status fault = startFrame(film, i, foresight, economy, pagers, renderer, started.back()); !fault.ok()) {
      // What was begun before it is whole: a film has the same pictures up to the fault with every renderer.
      started.pop_back();
      if (Status status = takeAll(); !status.ok()) return status;
      return fault;
    }
    if (started.size() <= ahead) continue;
    if (Status status = takeOne(); !status.ok()) return status;
  }
  if (Status status = takeAll(); !status.ok()) return status;
  return sink != nullptr ? sink->finish() : Status{};
}

}  // namespace tet4d::host
