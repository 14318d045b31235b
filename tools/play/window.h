// tet4d-play with a window, or one picture of it.
#pragma once

#include "tools/play/options.h"

namespace tet4d::play {

// Opens the window and plays until it is closed; returns the program's exit code.
int playInWindow(cli::Session& session, const Options& options);
// --offscreen --panels: what the window would show, as a PNG.
int drawPanels(cli::Session& session, const Options& options);

}  // namespace tet4d::play
