// What a user asks of tet4d-play: the table of options, and what of them cannot be.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/play/coloring.h"

namespace tet4d::play {

struct Options {
  std::vector<std::string> inputs;
  bool offscreen = false, flat = false, panels = false;
  ColoringOptions coloring;
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

// Examples and options, in the order of --help.
void addOptions(cli::Command& command, Options& o);

// True if the film goes to `output` as y4m, not as PNG.
bool isY4m(const Options& options, const std::string& output);
bool endsIn(const std::string& path, const std::string& suffix);

// Each throws Error (kUsage) with what to give instead.
// A name promises what is in the file.
void checkSuffixes(const Options& options, const std::string& output);
// Numbers of films.
void checkNumbers(const Options& options);
// Before any work: no output replaces an input, another output or, unless forced, an older file. `frames`: pictures.
void checkNames(const Options& options, const cli::CommonOptions& common, std::size_t frames);
// Options that belong to films mean nothing for a window.
void refuseFilmOptions(const Options& options, const cli::CommonOptions& common);
// Numbers of the window and its panels.
void checkWindow(const Options& options);

}  // namespace tet4d::play
