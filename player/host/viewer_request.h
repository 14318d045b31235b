// What a PlayerRequest means for a Viewer, in the window and off-screen. Private to player/host.
#pragma once

#include "player/host/viewer.h"
#include "player/host/window.h"

namespace tet4d::host {

ViewerOptions viewerOptions(const PlayerRequest& request);

// Starts the viewer in the context that is current, opens the files, and presses the keys of `typed`.
Status prepare(Viewer& viewer, const PlayerRequest& request, render::GlResolver resolver);

}  // namespace tet4d::host
