// tet4d-play: dynamic triangles → a window, pictures, films. Ponchio & Hormann 2008, sec. 7.1.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/core/time_spec.h"
#include "formats/hypermesh.h"
#include "libpreprocess/error.h"
#include "player/host/memory_plan.h"
#include "player/host/offscreen_gl.h"
#include "player/host/output_file.h"
#include "player/host/output_names.h"
#include "player/host/playback.h"
#include "player/host/png.h"
#include "player/host/viewer_files.h"
#include "player/host/window.h"
#include "player/scene/shot_file.h"
#include "tools/common/cli.h"
#include "tools/play/baseline.h"
#include "tools/play/coloring.h"
#include "tools/play/pagers.h"

namespace {

using namespace tet4d;

constexpr std::uint64_t kMostIoThreads = 64;

struct Options {
  std::vector<std::string> inputs;
  bool offscreen = false, flat = false, panels = false;
  play::ColoringOptions coloring;
  std::array<std::uint32_t, 2> size{1280, 720};
  std::string at, times, camera, write_camera, contact_sheet;
  std::string renderer = "auto";
  std::string format = "auto";
  std::string arrival = "wait", on_damage = "stop";
  std::uint64_t samples = 4, columns = 4, tiles = 0, gpu_memory = 0, io_threads = 1;
  double orbit_degrees = 0, fps = 25;
  std::optional<double> budget_ms, ui_scale;
  std::string typed, screenshot;  // for tests of the window
  std::uint64_t quit_after = 0;
};

// --at, --times, or every frame of the files. Frame numbers count in the table of all files' times.
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

bool endsIn(const std::string& path, const std::string& suffix) {
  return std::filesystem::path(path).extension() == suffix;
}

bool isY4m(const Options& options, const std::string& output) {
  if (options.format != "auto") return options.format == "y4m";
  return host::isStream(output) || endsIn(output, ".y4m");
}

// A name promises what is in the file.
void checkSuffixes(const Options& options, const std::string& output) {
  const std::string& sheet = options.contact_sheet;
  if (!sheet.empty() && !endsIn(sheet, ".png") && !host::isStream(sheet)) {
    throw Error(FaultCode::kUsage, sheet, "--contact-sheet", "is written as PNG, under a name that ends in .png",
                "give --contact-sheet sheet.png");
  }
  if (output.empty() || host::isStream(output)) return;
  const bool is_y4m = isY4m(options, output);
  if (endsIn(output, is_y4m ? ".y4m" : ".png")) return;
  throw Error(FaultCode::kUsage, output, "--output",
              is_y4m ? "is written as y4m, to a name that ends in .y4m, a pipe or -"
                     : "is none of what the player writes: PNG pictures (.png) or a y4m film (.y4m, a pipe or -)",
              "give -o frames/%05d.png or -o film.y4m");
}

void checkBudget(const Options& options) {
  if (options.budget_ms && (std::isnan(*options.budget_ms) || *options.budget_ms < 0)) {
    throw Error(FaultCode::kUsage, "", "--budget-ms", "expected 0, a number above it or inf", "give --budget-ms 40");
  }
}

void checkNumbers(const Options& options) {
  if (!std::isfinite(options.orbit_degrees)) {
    throw Error(FaultCode::kUsage, "", "--orbit", "expected a finite number of degrees", "give --orbit 90");
  }
  if (!std::isfinite(options.fps) || options.fps <= 0) {
    throw Error(FaultCode::kUsage, "", "--fps", "expected a finite number above 0", "give --fps 25");
  }
  checkBudget(options);
  if (options.budget_ms && options.arrival == "wait") {
    throw Error(FaultCode::kUsage, "", "--budget-ms",
                "makes pictures depend on the machine, and --arrival wait is exact", "give --arrival draw with it");
  }
  if (options.io_threads < 1 || options.io_threads > kMostIoThreads) {
    throw Error(FaultCode::kUsage, "", "--io-threads", "expected 1 to " + std::to_string(kMostIoThreads),
                "leave it out");
  }
}

// Before any work: no output replaces an input, another output or, unless forced, an older file.
void checkNames(const Options& options, const cli::CommonOptions& common, std::size_t frames) {
  std::vector<host::NamedPath> outputs{{"--stats", common.stats},
                                       {"--depfile", common.depfile},
                                       {"--write-camera", options.write_camera},
                                       {"--contact-sheet", options.contact_sheet}};
  if (isY4m(options, common.output)) {
    outputs.push_back({"--output", common.output});
  } else if (!common.output.empty() && common.output != "-") {
    for (std::size_t i = 0; i < frames && (i == 0 || host::hasNumber(common.output)); ++i)
      outputs.push_back({"--output", unwrap(host::frameName(common.output, i))});
  }
  std::vector<host::NamedPath> inputs{{"--camera", options.camera}, {"--config", common.config}};
  for (const std::string& input : options.inputs) inputs.push_back({"the input", input});
  unwrap(host::checkNamesDiffer(inputs, outputs));
  for (const std::string& path : {options.write_camera, options.contact_sheet})
    if (!path.empty()) unwrap(host::checkMayWrite(path, common.force));
}

// Null if no film is asked for, only a contact sheet or a camera file.
std::unique_ptr<host::FrameSink> sinkOf(const Options& options, const cli::CommonOptions& common, std::size_t frames) {
  if (common.output.empty()) return nullptr;
  if (isY4m(options, common.output)) return unwrap(host::makeY4mFilm(common.output, options.fps, common.force));
  if (common.output == "-") {
    throw Error(FaultCode::kUsage, "", "", "PNG frames cannot go to standard output", "give --format y4m");
  }
  return unwrap(host::makePngFrames(common.output, frames, common.force));
}

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
  const play::Pagers pagers(session, static_cast<unsigned>(options.io_threads), film, plan.frame_pages / plan.copies,
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

// The paper's baseline.
int playTets(cli::Session& session, const Options& options) {
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
  const play::ColoringOptions& coloring = options.coloring;
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
  play::playBaseline(session, file, times, options.camera, format, sink.get());
  return 0;
}

// The window's player, or one picture of it.
host::PlayerRequest requestOf(cli::Session& session, const Options& options) {
  host::PlayerRequest request;
  request.files = options.inputs;
  request.renderer = options.renderer;
  request.threads = static_cast<unsigned>(session.executor().threads());
  request.width = options.size[0];
  request.height = options.size[1];
  request.samples = static_cast<std::uint32_t>(options.samples);
  request.smooth = !options.flat && options.coloring.shading != "flat";
  const std::uint64_t half = session.memory().available() / 2;
  const std::uint64_t usual = session.options().memory_bytes != 0 ? half : host::usualPageBytes();
  request.budget_bytes = std::min(half, usual);
  request.gpu_bytes = std::min(half, options.gpu_memory != 0 ? options.gpu_memory : usual);
  request.ui_scale = options.ui_scale;
  request.budget_ms = options.budget_ms;
  request.typed = options.typed;
  request.quit_after = options.quit_after;
  request.stop = outofcore::interruptRequested;
  request.screenshot = options.screenshot;
  if (options.inputs.empty()) return request;
  std::vector<dyntri::File> opened;
  for (const std::string& input : options.inputs) opened.push_back(unwrap(host::openDynamicTriangles(input)));
  for (std::size_t i = 0; i < opened.size(); ++i)
    request.colorings.push_back(play::coloringOf(options.coloring, options.inputs[i], opened[i]));
  std::vector<scene::SceneFile> files;
  for (const dyntri::File& file : opened) files.push_back({&file, std::nullopt, true});
  if (!options.at.empty()) request.time = timesOf(options, files).front().time;
  if (!options.camera.empty()) request.shot = shotOf(options, files);
  return request;
}

// What an option that belongs to films means for a window.
void refuseFilmOptions(const Options& options, const cli::CommonOptions& common) {
  for (const auto& [name, is_given] : {std::pair{"--output", !common.output.empty() && !options.panels},
                                       {"--times", !options.times.empty()},
                                       {"--contact-sheet", !options.contact_sheet.empty()},
                                       {"--write-camera", !options.write_camera.empty()},
                                       {"--orbit", options.orbit_degrees != 0},
                                       {"--renderer tets", options.renderer == "tets"}}) {
    if (!is_given) continue;
    throw Error(
        FaultCode::kUsage, "", name,
        options.panels ? "cannot go with --panels" : "is for pictures in files, and without --offscreen a window opens",
        options.panels ? "leave it out" : "give --offscreen too");
  }
}

// What the window draws its panels with, and what it opens.
void checkWindow(const Options& options) {
  checkBudget(options);
  if (options.ui_scale && !(*options.ui_scale >= 0.5 && *options.ui_scale <= 8))
    throw Error(FaultCode::kUsage, "", "--ui-scale", "expected a number between 0.5 and 8", "give --ui-scale 2");
}

int playInWindow(cli::Session& session, const Options& options) {
  if (options.panels)
    throw Error(FaultCode::kUsage, "", "--panels", "draws a picture into a file", "give --offscreen and -o too");
  checkWindow(options);
  refuseFilmOptions(options, session.options());
  unwrap(host::runWindow(requestOf(session, options)));
  session.progress().step(0);  // throws after an interrupt
  return 0;
}

int drawPanels(cli::Session& session, const Options& options) {
  const std::string& output = session.options().output;
  refuseFilmOptions(options, session.options());
  checkWindow(options);
  if (output.empty() || output == "-" || !endsIn(output, ".png") || host::hasNumber(output)) {
    throw Error(FaultCode::kUsage, output, "--panels", "draws one picture, as PNG",
                "give -o player.png, and --at for its time");
  }
  unwrap(host::checkMayWrite(output, session.options().force));
  const render::Image image = unwrap(host::drawWithPanels(requestOf(session, options)));
  unwrap(host::writeFile(output, unwrap(host::encodePng(image, output)), session.options().force));
  return 0;
}

// One a file, with the file's name where there are several.
std::vector<host::Legend> legendsOf(const Options& options, std::span<const scene::SceneFile> files) {
  std::vector<host::Legend> legends;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const scene::Coloring coloring = play::coloringOf(options.coloring, options.inputs[i], *files[i].file);
    const std::string note = files.size() > 1 ? std::filesystem::path(options.inputs[i]).filename().string() : "";
    for (host::Legend& legend :
         host::legendOf(*files[i].file, coloring, files[i].column ? &*files[i].column : nullptr, note))
      legends.push_back(std::move(legend));
  }
  return legends;
}

int playFiles(cli::Session& session, const Options& options) {
  if (!options.offscreen) return playInWindow(session, options);
  if (options.panels) return drawPanels(session, options);
  if (options.inputs.empty())
    throw Error(FaultCode::kUsage, "", "FILE", "no file is named, and there is no window to open one in",
                "give tet4d-play FILE.t4d --offscreen -o frames/%05d.png");
  if (options.ui_scale)
    throw Error(FaultCode::kUsage, "", "--ui-scale", "scales panels, and there are none", "give --panels too");
  if (options.renderer == "tets") return playTets(session, options);
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
    play::applyColoring(session, options.coloring, options.inputs[i], film.files[i]);
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

}  // namespace

int main(int argc, char** argv) {
  Options o;
  cli::Command command("tet4d-play", "Plays dynamic triangles: pictures or a film at any time, between frames too.");
  command.example("tet4d-play dam.t4d", "a window; ? lists the keys")
      .example("tet4d-play dam.t4d --offscreen -o frames/%05d.png", "one picture a frame of the file")
      .example("tet4d-play dam.t4d --offscreen --at 0.35 --color velocity --map magma --legend -o dam.png",
               "coloured by a column of the file, with what the colours mean")
      .example("tet4d-play dam.t4d --offscreen --times 0f:20f:0.1f --format y4m -o - | ffmpeg -i - dam.mp4",
               "ten times slower, as a film")
      .example("tet4d-play dam.t4d --offscreen --at 0.35 --write-camera camera.json -o dam.png",
               "one picture, and its camera to change")
      .positional("FILE", "dynamic triangles (.t4d); several share one scene, one camera and the world's time",
                  &o.inputs, true)
      .heading("Pictures")
      .flag("--offscreen", "draw into files, without a display; without it a window opens", &o.offscreen)
      .option("--size", "WxH", "of a picture or the window, pixels", cli::Extent{&o.size})
      .option("--at", "T", "one picture at world time T, or at frame number T with the suffix f", &o.at)
      .option("--times", "A:B:STEP",
              "pictures from A to B, both included; A >= B with STEP < 0 runs backward; T,A:B:STEP,… jumps; default: "
              "every frame of the file",
              &o.times)
      .option(
          "--renderer", "WHICH",
          "OpenGL; plain C++; tetrahedra of one .t4h, flat, as the paper's baseline; auto: gl in a window, cpu with "
          "--offscreen, where OpenGL has no GPU and is slower",
          cli::Choice{&o.renderer, {"auto", "gl", "cpu", "tets"}})
      .option("--samples", "N", "samples a pixel: 1, 4, 9 or 16", &o.samples)
      .flag("--flat", "one normal a triangle instead of smooth ones", &o.flat)
      .flag("--panels", "with the window's panels over the picture", &o.panels)
      .option("--ui-scale", "S",
              "size of panels and their letters, 1: 13 pixels; default: what the display says of itself", &o.ui_scale)
      .option("--type", "KEYS", "keys pressed in the window once everything is open", &o.typed, cli::kNotInHelp)
      .option("--quit-after", "N", "close the window after N pictures", &o.quit_after, cli::kNotInHelp)
      .option("--screenshot", "FILE", "what the window shows at the end", &o.screenshot,
              cli::kNotInHelp | cli::kIsOutput)
      .heading("Colours")
      .option(
          "--shading", "WHICH",
          "normals: summed up in the slice, the file's column \"normal\", or one a triangle; none: colours as they are",
          cli::Choice{&o.coloring.shading, {"slice", "file", "flat", "none"}})
      .option("--color", "NAME", "colour by a column; NAME:0, NAME:1 … a component, NAME:magnitude its length",
              &o.coloring.color)
      .option("--color-by", "WHAT", "part: each part of a file a colour of its own; auto: as --color says",
              cli::Choice{&o.coloring.by, {"auto", "part"}})
      .option("--range", "LO:HI",
              "values at the ends of the map; default: all but the lowest and highest 1 % in the file, read once",
              &o.coloring.range)
      .option("--map", "NAME", "colours from low to high",
              cli::Choice{&o.coloring.map, {"viridis", "cividis", "inferno", "magma", "cool-warm", "grey"}})
      .flag("--reverse-map", "the map from its other end", &o.coloring.reverse_map)
      .option("--scale", "WHICH", "of the map: log for equal factors, values at or below 0 take its lowest colour",
              cli::Choice{&o.coloring.scale, {"linear", "log"}})
      .flag("--legend", "draw into the picture what the colours mean; the window does unless told otherwise (k)",
            &o.coloring.legend)
      .heading("Camera")
      .option("--camera", "FILE", "camera, lights and material (JSON); default: fitted to the data", &o.camera)
      .option("--orbit", "DEG", "turn of the camera about the vertical over the whole film", &o.orbit_degrees)
      .option("--write-camera", "FILE", "write the camera, as --camera reads it", &o.write_camera, cli::kIsOutput)
      .heading("Film")
      .option("--format", "WHAT", "of the output; auto: by the name's end .png or .y4m, y4m for - and pipes",
              cli::Choice{&o.format, {"auto", "png", "y4m"}})
      .option("--fps", "N", "pictures a second of a y4m film", &o.fps)
      .option("--contact-sheet", "FILE", "all pictures in one PNG, scaled down", &o.contact_sheet, cli::kIsOutput)
      .option("--columns", "N", "of the contact sheet", &o.columns)
      .option("--tiles", "N", "most pictures on the contact sheet, taken evenly; 0: all", &o.tiles)
      .heading("Pages")
      .option("--arrival", "WHAT", "wait for a picture's pages; or draw, at --fps, what has come, as a window does",
              cli::Choice{&o.arrival, {"wait", "draw"}})
      .option("--budget-ms", "MS", "with --arrival draw: samples and size of moving pictures give way to keep to it",
              &o.budget_ms, cli::kMayBeInfinite)
      .option("--on-damage", "WHAT", "a page that fails its checks ends the film, or is named and left out",
              cli::Choice{&o.on_damage, {"stop", "skip"}})
      .option("--gpu-memory", "SIZE", "of copies of pages in the driver; default: half of what --memory leaves",
              cli::Size{&o.gpu_memory}, cli::kKeepsResult)
      .option("--io-threads", "N", "that read each file; half of --threads check and decode", &o.io_threads,
              cli::kKeepsResult)
      .heading("General")
      .common({cli::kOutput, cli::kThreads, cli::kMemory, cli::kForce, cli::kStats, cli::kDepfile});
  return cli::run(argc, argv, command, [&](cli::Session& session) {
    if (o.renderer == "auto") o.renderer = o.offscreen ? "cpu" : "gl";
    return playFiles(session, o);
  });
}
