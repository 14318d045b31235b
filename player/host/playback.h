// Plays a film off-screen: for each time the camera, the pages, the picture.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "player/host/contact_sheet.h"
#include "player/host/film.h"
#include "player/render/renderer.h"
#include "player/scene/dyntri_chooser.h"
#include "player/stream/page_source.h"

namespace tet4d::host {

struct Film {
  scene::Shot shot;
  scene::Format format;
  bool smooth = true;
  double orbit_degrees = 0;              // the camera's turn over the whole film, in equal steps; 360 closes the circle
  std::span<const float> frame_numbers;  // when, in frames of the file; one picture each
  // Most bytes the plain C++ renderer may take for the triangles of one picture; without effect on gl.
  std::uint64_t triangle_bytes = std::numeric_limits<std::uint64_t>::max();
};

// The shot of picture i: the film's, turned.
scene::Shot shotOfFrame(const Film& film, std::size_t i);

// What one picture cost.
struct FrameCost {
  std::size_t index;  // of frame_numbers
  double ms;          // to bring pages in, choose, draw and read the picture back; not to encode it
  std::uint64_t drawn, processed, bytes_touched;
};

// Draws all frames in order into `sink` and `sheet`, either of which may be null. `after` is called after each frame
// and may throw to stop; nothing is left under a final name then but finished pictures. The first Fault ends it;
// kOutOfMemory if the triangles of a picture exceed film.triangle_bytes.
Status play(const dyntri::File& file, const Film& film, stream::PageSource& source, render::Renderer& renderer,
            FrameSink* sink, ContactSheet* sheet, const std::function<void(const FrameCost&)>& after);

}  // namespace tet4d::host
