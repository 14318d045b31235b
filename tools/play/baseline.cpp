#include "tools/play/baseline.h"

#include <algorithm>

#include "libpreprocess/error.h"
#include "player/host/offscreen_gl.h"
#include "player/scene/shot_file.h"

namespace tet4d::play {

void playBaseline(cli::Session& session, const hypermesh::File& file, const std::vector<SliceTime>& times,
                  const std::string& camera, const scene::Format& format, host::FrameSink* sink) {
  unwrap(render::sampleGrid(format));
  const scene::WorldBox box = scene::worldBox(file.header().index_to_world, file.header().bounds);
  const scene::Shot fitted = scene::defaultShot(box, static_cast<double>(format.width) / format.height);
  const host::TetFilm film{&file, camera.empty() ? fitted : unwrap(scene::readShot(camera, fitted)), format, times};
  const std::uint64_t half = session.memory().available() / 2;
  auto renderer = unwrap(host::makeOffscreenRenderer("tets", 1, half));
  stream::TetSource source(file, half / 2);
  session.stats().expectFrames();
  session.progress().phase("draw", times.size());
  std::uint64_t drawn = 0, gpu_bytes = 0;
  unwrap(host::playTets(film, source, *renderer, sink, [&](const host::TetFrameCost& cost) {
    cli::Stats::Frame frame;
    frame.time = times[cost.index].time;
    frame.ms = cost.ms;
    frame.drawn = cost.drawn;
    frame.processed = cost.processed;
    frame.bytes_touched = cost.bytes_touched;
    session.stats().frame(frame);
    session.progress().step(cost.index + 1);
    drawn += cost.drawn;
    gpu_bytes = std::max(gpu_bytes, renderer->gpuBytes());
  }));
  session.stats().count("frames", times.size());
  session.stats().count("tets", file.header().tets);
  session.stats().count("triangles_drawn", drawn);
  session.stats().count("gpu_bytes", gpu_bytes);
}

}  // namespace tet4d::play
