// Plays a film off-screen: for each time the camera, the pages, the picture.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "player/host/contact_sheet.h"
#include "player/host/film.h"
#include "player/host/legend.h"
#include "player/render/renderer.h"
#include "player/scene/dyntri_chooser.h"
#include "player/scene/frame_budget.h"
#include "player/scene/scene_files.h"
#include "player/stream/pager.h"

namespace tet4d::host {

// When a picture is taken: a world time, and where that is in each file.
struct PictureTime {
  double time = 0;
  std::vector<std::optional<float>> frames;  // one a file; nothing where the file's times do not hold it
};

// The same world time in every file.
PictureTime pictureTime(std::span<const scene::SceneFile> files, double time);

// When a picture's pages have not come yet: wait for them, for an exact film; or draw at the film's pace what is there,
// as a window does.
enum class Arrival { kWait, kDraw };

struct Film {
  std::vector<scene::SceneFile> files;
  scene::Shot shot;
  scene::Format format;
  bool smooth = true;
  double orbit_degrees = 0;          // the camera's turn over the whole film, in equal steps; 360 closes the circle
  std::vector<PictureTime> times;    // one picture each
  std::vector<Legend> legends = {};  // drawn into every picture
  // Most bytes the plain C++ renderer may take for the triangles of one picture; without effect on gl.
  std::uint64_t triangle_bytes = std::numeric_limits<std::uint64_t>::max();
  Arrival arrival = Arrival::kWait;
  double fps = 25;  // the pace of kDraw; a late picture delays those after it
  // Milliseconds a moving picture may take; samples and size give way, and come back at rest. Only with kDraw: such a
  // film depends on the machine.
  double budget_ms = std::numeric_limits<double>::infinity();
  bool skip_damaged = false;  // a page that cannot come in is left out; otherwise it ends the film
};

// The shot of picture i: the film's, turned.
scene::Shot shotOfFrame(const Film& film, std::size_t i);

// What one picture cost.
struct FrameCost {
  std::size_t index;  // of the film's times
  double ms;          // to bring pages in, choose, draw, wait and read the picture back; not to encode it, nor what
                      // is done for the next picture meanwhile
  double load_ms;     // of it: asking and waiting for pages
  double choose_ms;   // of it: camera and triangles
  double draw_ms;     // of it: drawing and reading back
  std::uint64_t drawn, processed;
  std::uint64_t absent;         // pages that should be drawn and were not there
  std::uint64_t bytes_touched;  // stored bytes of pages used for the first time since they were read
  std::uint64_t prefetched;     // of them, what had come before
  double samples;               // a pixel; below 1 where a picture was drawn smaller and enlarged
};

// How a film kept to its budget: the last 64 pictures, without those that were the first of their kind (DrawnKinds).
using BudgetReport = scene::FrameBudget::Report;

// Draws all frames in order into `sink` and `sheet`, either of which may be null. `after` is called after each frame
// and may throw to stop; nothing is left under a final name then but finished pictures. The first Fault ends it,
// after the pictures before it have gone to the sink;
// kOutOfMemory if the triangles of a picture exceed film.triangle_bytes. With Arrival::kWait the pictures depend on
// nothing but the film.
// pagers: one a file. Faults of pages that were skipped stay in them (Pager::takeFaults()).
Status play(const Film& film, std::span<stream::Pager* const> pagers, render::Renderer& renderer, FrameSink* sink,
            ContactSheet* sheet, const std::function<void(const FrameCost&)>& after, BudgetReport* report = nullptr);

}  // namespace tet4d::host
