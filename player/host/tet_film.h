// Plays a hypermesh with the renderer of tetrahedra, the paper's baseline: pages alive at t, all their tetrahedra.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "formats/core/time_spec.h"
#include "formats/hypermesh.h"
#include "player/host/film.h"
#include "player/render/renderer.h"
#include "player/scene/shot.h"
#include "player/stream/tet_source.h"

namespace tet4d::host {

struct TetFilm {
  const hypermesh::File* file = nullptr;
  scene::Shot shot;
  scene::Format format;
  std::vector<SliceTime> times;  // one picture each
};

struct TetFrameCost {
  std::size_t index;        // of the film's times
  double ms;                // as FrameCost
  std::uint64_t drawn;      // triangles of the slice
  std::uint64_t processed;  // triangles the shader makes room for: two a tetrahedron
  std::uint64_t tets;       // of the pages drawn
  std::uint64_t bytes_touched;
};

// The time at which lifespans are closed, as dyntri-build takes it.
float lastTime(const hypermesh::File& file);

// Draws all frames in order into `sink`, which may be null. The first Fault ends it.
Status playTets(const TetFilm& film, stream::TetSource& source, render::Renderer& renderer, FrameSink* sink,
                const std::function<void(const TetFrameCost&)>& after);

}  // namespace tet4d::host
