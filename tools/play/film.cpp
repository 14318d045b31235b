#include "tools/play/film.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

#include "formats/core/time_spec.h"
#include "libpreprocess/error.h"
#include "player/host/memory_plan.h"
#include "player/host/offscreen_gl.h"
#include "player/host/output_file.h"
#include "player/host/png.h"
#include "player/host/viewer_files.h"
#include "player/scene/shot_file.h"
#include "tools/play/coloring.h"
#include "tools/play/pagers.h"

namespace tet4d::play {
namespace {

void writeText(const std::string& path, const std::string& text, bool force) {
  unwrap(host::writeFile(path, std::as_bytes(std::span(text)), force));
}

void drawAll(cli::Session& session, const Options& options, host::Film& film) {
  const cli::CommonOptions& common = session.options();
  unwrap(render::sampleGrid(film.format));
  std::optional<host::ContactSheet> sheet;
  if (!options.contact_sheet.empty()) sheet.emplace(options.columns, film.times.size(), options.tiles);
  const bool is_gl = options.renderer == "gl";
  const host::MemoryPlan plan = host::planMemory(film, sheet ? &*sheet : nullptr, is_gl);
  outofcore::MemoryBudget& memory = session.memory();
  const auto pictures = memory.reserve(plan.pictures, "a picture with its samples (--size, --samples)");
  const auto tiles = memory.reserve(plan.sheet, "the contact sheet");
  const auto normals = memory.reserve(plan.normals, "summing normals (--flat does without)");
  const auto pages = memory.reserve(plan.frame_pages, "the pages of one picture");
  // Half of what is left holds the triangles of a picture in plain C++, or the driver's copies; the other half keeps
  // pages of earlier pictures and of those to come.
  const std::uint64_t half = memory.available() / 2, usual = common.memory_bytes != 0 ? half : host::usualPageBytes();
  film.triangle_bytes = half;
  const std::uint64_t gpu_bytes = std::min(half, options.gpu_memory != 0 ? options.gpu_memory : usual);
  auto renderer = unwrap(
      host::makeOffscreenRenderer(options.renderer, static_cast<unsigned>(session.executor().threads()), gpu_bytes));
  const std::unique_ptr<host::FrameSink> sink = sinkOf(options, common, film.times.size());
  const Pagers pagers(session, static_cast<unsigned>(options.io_threads), film, plan.frame_pages / plan.copies,
                      std::min(half, usual));
  session.progress().phase("draw", film.times.size());
  host::BudgetReport report;
  std::uint64_t drawn = 0, most_gpu_bytes = 0;
  double draw_ms = 0;
  const auto after = [&](const host::FrameCost& c) {
    drawn += c.drawn;
    draw_ms += c.draw_ms;
    most_gpu_bytes = std::max(most_gpu_bytes, renderer->gpuBytes());
    session.stats().frame({film.times[c.index].time, c.ms, c.drawn, c.processed, c.bytes_touched, c.prefetched,
                           c.absent, c.load_ms, c.choose_ms, c.draw_ms, c.samples});
    pagers.warn(session, film.skip_damaged);
    session.progress().step(c.index + 1);
  };
  unwrap(host::play(film, pagers.all(), *renderer, sink.get(), sheet ? &*sheet : nullptr, after, &report));
  if (options.budget_ms) {
    session.stats().error("budget_p95_ms", report.p95_ms);
    session.stats().error("budget_prediction_p95", report.error_p95);
  }
  pagers.count(session);
  session.stats().count("triangles_drawn", drawn);
  session.stats().count("gpu_bytes", most_gpu_bytes);
  if (draw_ms > 0) {
    session.detail(std::to_string(drawn) + " triangles in " + std::to_string(film.times.size()) + " pictures, " +
                   std::to_string(static_cast<std::uint64_t>(static_cast<double>(drawn) / draw_ms * 1000)) +
                   " a second of drawing");
  }
  if (sheet) {
    const std::vector<std::byte> png = unwrap(host::encodePng(sheet->compose(), options.contact_sheet));
    unwrap(host::writeFile(options.contact_sheet, png, common.force));
  }
}

// One a file, with the file's name where there are several.
std::vector<host::Legend> legendsOf(const Options& options, std::span<const scene::SceneFile> files) {
  std::vector<host::Legend> legends;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const scene::Coloring coloring = coloringOf(options.coloring, options.inputs[i], *files[i].file);
    const std::string note = files.size() > 1 ? std::filesystem::path(options.inputs[i]).filename().string() : "";
    for (host::Legend& legend :
         host::legendOf(*files[i].file, coloring, files[i].column ? &*files[i].column : nullptr, note))
      legends.push_back(std::move(legend));
  }
  return legends;
}

}  // namespace

std::vector<host::PictureTime> timesOf(const Options& options, std::span<const scene::SceneFile> files) {
  if (!options.at.empty() && !options.times.empty()) {
    throw Error(FaultCode::kUsage, "", "", "--at and --times are both given", "give one of the two");
  }
  const std::vector<double> table = scene::sceneTimes(files);
  std::vector<SliceTime> times;
  if (!options.at.empty()) {
    times = {unwrap(parseTime(options.at, table))};
  } else {
    const std::string all = "0f:" + std::to_string(table.size() - 1) + "f:1f";
    times = unwrap(parseTimeList(options.times.empty() ? all : options.times, table));
  }
  std::vector<host::PictureTime> pictures;
  for (const SliceTime& time : times) {
    pictures.push_back(host::pictureTime(files, time.time));
    // A frame number that the user wrote is exact; by way of the world time it need not be.
    if (files.size() == 1) pictures.back().frames[0] = sliceFrame(time.frame);
  }
  return pictures;
}

scene::Shot shotOf(const Options& options, std::span<const scene::SceneFile> files) {
  const scene::WorldBox box = scene::sceneBox(files);
  const scene::Shot fitted = scene::defaultShot(box, static_cast<double>(options.size[0]) / options.size[1]);
  return options.camera.empty() ? fitted : unwrap(scene::readShot(options.camera, fitted));
}

std::unique_ptr<host::FrameSink> sinkOf(const Options& options, const cli::CommonOptions& common, std::size_t frames) {
  if (common.output.empty()) return nullptr;
  if (isY4m(options, common.output)) return unwrap(host::makeY4mFilm(common.output, options.fps, common.force));
  if (common.output == "-") {
    throw Error(FaultCode::kUsage, "", "", "PNG frames cannot go to standard output", "give --format y4m");
  }
  return unwrap(host::makePngFrames(common.output, frames, common.force));
}

int playFilm(cli::Session& session, const Options& options) {
  const cli::CommonOptions& common = session.options();
  const bool draws = !common.output.empty() || !options.contact_sheet.empty();
  if (!draws && options.write_camera.empty()) {
    throw Error(FaultCode::kUsage, "", "", "no output is named",
                "give -o frames/%05d.png, -o film.y4m, --contact-sheet or --write-camera");
  }
  checkNumbers(options);
  checkSuffixes(options, common.output);
  std::vector<dyntri::File> opened;
  std::uint64_t triangles = 0;
  for (const std::string& input : options.inputs) {
    opened.push_back(unwrap(host::openDynamicTriangles(input)));
    session.dependsOn(input);
    triangles += opened.back().header().triangles;
    if (opened.back().header().triangles == 0) session.warn(input + " has no triangles: nothing of it is drawn");
  }
  if (!options.camera.empty()) session.dependsOn(options.camera);
  host::Film film;
  for (const dyntri::File& file : opened) film.files.push_back({&file, std::nullopt, true});
  for (std::size_t i = 0; i < film.files.size(); ++i)
    applyColoring(session, options.coloring, options.inputs[i], film.files[i]);
  if (options.coloring.legend) film.legends = legendsOf(options, film.files);
  film.times = timesOf(options, film.files);
  checkNames(options, common, film.times.size());
  film.shot = shotOf(options, film.files);
  film.format = {options.size[0], options.size[1], static_cast<std::uint32_t>(options.samples)};
  film.smooth = !options.flat && options.coloring.shading != "flat";
  film.orbit_degrees = options.orbit_degrees;
  film.arrival = options.arrival == "wait" ? host::Arrival::kWait : host::Arrival::kDraw;
  film.fps = options.fps;
  if (options.budget_ms) film.budget_ms = *options.budget_ms;
  film.skip_damaged = options.on_damage == "skip";
  session.stats().expectFrames();
  session.stats().count("triangles", triangles);
  session.stats().count("frames", draws ? film.times.size() : 0);
  if (!options.write_camera.empty()) writeText(options.write_camera, scene::formatShot(film.shot), common.force);
  if (draws) drawAll(session, options, film);
  return 0;
}

}  // namespace tet4d::play
