#include "tools/play/baseline.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "formats/core/time_spec.h"
#include "formats/hypermesh.h"
#include "libpreprocess/error.h"
#include "player/host/offscreen_gl.h"
#include "player/host/tet_film.h"
#include "player/scene/shot_file.h"
#include "tools/play/film.h"

namespace tet4d::play {

namespace {

void drawTets(cli::Session& session, const hypermesh::File& file, const std::vector<SliceTime>& times,
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

}  // namespace

int playBaseline(cli::Session& session, const Options& options) {
  const cli::CommonOptions& common = session.options();
  if (options.inputs.size() != 1 || common.output.empty() || !options.contact_sheet.empty() ||
      options.orbit_degrees != 0) {
    throw Error(FaultCode::kUsage, "", "--renderer tets", "draws one hypermesh into pictures or a film, without more",
                "give tet4d-play FILE.t4h --offscreen --renderer tets -o frames/%05d.png");
  }
  checkNumbers(options);
  checkSuffixes(options, common.output);
  const hypermesh::File file = unwrap(hypermesh::File::open(options.inputs[0]));
  session.dependsOn(options.inputs[0]);
  if (!options.camera.empty()) session.dependsOn(options.camera);
  if (!options.at.empty() && !options.times.empty())
    throw Error(FaultCode::kUsage, "", "", "--at and --times are both given", "give one of the two");
  const ColoringOptions& coloring = options.coloring;
  if (!coloring.color.empty() || !coloring.range.empty() || coloring.shading == "file" || coloring.shading == "none" ||
      coloring.by != "auto" || coloring.legend)
    throw Error(FaultCode::kUsage, "", "--renderer tets", "knows neither columns, parts nor normals of the file",
                "draw the .t4d of the hypermesh: dyntri-build");
  const std::string all = "0f:" + std::to_string(file.times().size() - 1) + "f:1f";
  const std::string& asked = !options.at.empty() ? options.at : options.times;
  const std::vector<SliceTime> times = unwrap(parseTimeList(asked.empty() ? all : asked, file.times()));
  checkNames(options, common, times.size());
  const scene::Format format{options.size[0], options.size[1], static_cast<std::uint32_t>(options.samples)};
  const std::unique_ptr<host::FrameSink> sink = sinkOf(options, common, times.size());
  drawTets(session, file, times, options.camera, format, sink.get());
  return 0;
}

}  // namespace tet4d::play
