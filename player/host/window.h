// The player's window, and the same player drawn off-screen once.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/core/result.h"
#include "player/render/image.h"
#include "player/scene/coloring.h"
#include "player/scene/shot.h"

namespace tet4d::host {

struct PlayerRequest {
  std::vector<std::string> files;  // opened in order; one that cannot be is a fault
  std::string renderer = "gl";     // or "cpu"
  unsigned threads = 1;
  std::uint32_t width = 1280, height = 720;  // framebuffer off-screen, units of the screen for a window
  std::uint32_t samples = 4;
  bool smooth = true;
  std::uint64_t budget_bytes = std::uint64_t{1} << 30;  // of pages, of all files together, those to come too
  std::uint64_t gpu_bytes = std::uint64_t{1} << 30;     // of their copies in the driver
  std::optional<double> ui_scale;                       // pixels a unit of the panels; without: the display's own
  std::vector<scene::Coloring> colorings;               // of `files`, in order; others: by material
  std::optional<double> budget_ms;                      // of a picture while something moves
  std::optional<double> time;                           // world; without: the first
  std::optional<scene::Shot> shot;                      // without: fitted
  std::string directory = ".";                          // of what is saved
  std::string typed;           // keys pressed once everything is open; a tabulator is Tab, an escape Esc
  std::function<bool()> stop;  // asked between pictures, at least five times a second: true closes the window
  // For tests: the window closes after so many pictures (0: never), and leaves what it shows in a file.
  std::uint64_t quit_after = 0;
  std::string screenshot;
};

// True if this build has panels off-screen; a window.
bool hasPanels();
bool hasWindow();

// Opens the window and plays until it is closed. Draws only when something changed, and sleeps in between. Fault
// kNotBuilt if this build has no window; kIo if there is no display (names DISPLAY) or its OpenGL is below 3.3 (names
// the version).
Status runWindow(const PlayerRequest& request);

// The window's content as a picture, off-screen.
Result<render::Image> drawWithPanels(const PlayerRequest& request);

}  // namespace tet4d::host
