// The panels over the picture: files, colours, view, quality, statistics, what is saved; the time line; messages; keys.
//
// They read and change a Viewer within an ImGui frame. Private to player/host; sizes are ImGui's units.
#pragma once

#include "player/host/viewer.h"

namespace tet4d::host {

// Dark and translucent. scale: framebuffer pixels a unit, for the font.
void stylePanels(double scale);

// Where panels stand, units. In a small window the side panel gives way first, then the bar.
struct PanelLayout {
  double width = 0, height = 0;
  bool side = false, bar = false;
  double side_right = 0, bar_top = 0;
};
PanelLayout panelLayout(const ViewerState& state);

void layOutPanels(Viewer& viewer);

// How long a message is shown.
double messageSeconds(const Message& message);

void toggleRoom(scene::Background& background);
void toggleDark(scene::Background& background);

// The parts. Each is called within a window of its own or the side panel.
void layOutBar(Viewer& viewer, const PanelLayout& layout);
void layOutSide(Viewer& viewer, const PanelLayout& layout);
void layOutHelp(const PanelLayout& layout);
void layOutMessages(Viewer& viewer, const PanelLayout& layout);

// Remembers where the last widget stands.
void markPlace(ViewerState& state, const char* name);

}  // namespace tet4d::host
