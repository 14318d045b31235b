// The panels over the picture: files, what is saved, colours, columns, material, background, view, statistics, budget;
// the time line; messages; keys; what a newcomer can do.
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
  bool bar_is_tall = false;  // two rows of buttons where one is too long
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
void layOutColors(Viewer& viewer);
void layOutColumns(Viewer& viewer);
void layOutMaterial(Viewer& viewer);
void layOutBackground(Viewer& viewer);
// Until the first touch; where nothing is open, what to do about it.
void layOutHint(Viewer& viewer, const PanelLayout& layout);
void layOutMessages(Viewer& viewer, const PanelLayout& layout);

// Colours of a column, as they first are; past the last one of the material.
void colorByColumn(ViewerFile& file, std::size_t column);

bool editColor(const char* label, glm::dvec3& color);

// Remembers where the last widget stands.
void markPlace(ViewerState& state, const char* name);

}  // namespace tet4d::host
