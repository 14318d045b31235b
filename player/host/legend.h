// What the colours of a picture mean, drawn into it: a bar with ticks for a column, a list for parts.
//
// Drawn by the processor into the finished picture, with letters of our own (stroke_font.h): the same for every
// renderer, and in builds without Dear ImGui.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "player/host/stroke_font.h"
#include "player/scene/camera_control.h"
#include "player/scene/coloring.h"

namespace tet4d::host {

struct Legend {
  std::string title;         // the column's name as it stands in the file, a unit in it included; or "parts"
  std::string note;          // under the title: the file, where several are drawn; may be empty
  std::vector<Rgb> bar;      // a column's colours from low to high, evenly along the bar; empty for parts
  double low = 0, high = 1;  // the bar's ends
  bool logarithmic = false;
  struct Entry {
    Rgb color;
    std::string label;
  };
  std::vector<Entry> entries;  // parts
};

// Of one file as it is drawn; nothing if `drawn` (null allowed) is nothing. `note` as above.
std::vector<Legend> legendOf(const dyntri::File& file, const scene::Coloring& coloring, const scene::DrawColumn* drawn,
                             std::string_view note);

struct Tick {
  double place = 0;  // along the bar, 0..1 from low to high
  std::string label;
};
// Round numbers within low .. high, ascending, at most `most` and, where the range is not empty, two or more: steps of
// 1, 2 or 5 times a power of ten; on a logarithmic bar powers of ten, or such steps within a few of them.
std::vector<Tick> ticksOf(double low, double high, bool logarithmic, std::size_t most);

// Lines of text of a picture, pixels: readable from 240 pixels upwards.
double legendLine(std::uint32_t width, std::uint32_t height);

// Draws the legends side by side at the right end of `within` (pixels), those that fit, on a plate: light, or dark on a
// dark background. A picture too small for one stays as it is.
void drawLegends(render::Image& image, std::span<const Legend> legends, const scene::Frame& within, double line_px,
                 bool dark);

// How much of `within` they take at its right end, pixels, with the margins on either side; 0 for none.
double legendsWidth(std::span<const Legend> legends, const scene::Frame& within, double line_px);

// Whether letters on this background should be light.
bool isDark(const scene::Background& background);

}  // namespace tet4d::host
