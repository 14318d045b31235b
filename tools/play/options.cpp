#include "tools/play/options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "libpreprocess/error.h"
#include "player/host/film.h"
#include "player/host/output_file.h"
#include "player/host/output_names.h"

namespace tet4d::play {
namespace {

constexpr std::uint64_t kMostIoThreads = 64;

void checkBudget(const Options& options) {
  if (options.budget_ms && (std::isnan(*options.budget_ms) || *options.budget_ms < 0)) {
    throw Error(FaultCode::kUsage, "", "--budget-ms", "expected 0, a number above it or inf", "give --budget-ms 40");
  }
}

}  // namespace

void addOptions(cli::Command& command, Options& o) {
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
      .option("--renderer", "WHICH",
              "gl: OpenGL; cpu: plain C++; auto: gl in a window, cpu with --offscreen, where OpenGL has no GPU and is "
              "slower; tets: "
              "the tetrahedra of one .t4h, flat, as the paper's baseline",
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
      .option("--shading", "WHICH",
              "slice: by normals summed up in the slice; file: by the file's column \"normal\"; flat: one normal a "
              "triangle; none: "
              "colours as they are",
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

void checkWindow(const Options& options) {
  checkBudget(options);
  if (options.ui_scale && !(*options.ui_scale >= 0.5 && *options.ui_scale <= 8))
    throw Error(FaultCode::kUsage, "", "--ui-scale", "expected a number between 0.5 and 8", "give --ui-scale 2");
}

}  // namespace tet4d::play
