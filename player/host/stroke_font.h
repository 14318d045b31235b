// Letters drawn as strokes into a picture, at any size, without a font file: what a legend is written with.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "player/render/image.h"

namespace tet4d::host {

using Rgb = std::array<std::uint8_t, 3>;

// ASCII; what is not is drawn as a hollow box, one for each UTF-8 character. Pixels.
double textWidth(std::string_view text, double line_px);

// Writes from x rightwards; capitals stand on baseline_y and are 0.6 line_px high, descenders reach 0.2 below. What
// lies outside the picture is cut off. O(pixels of the text's box * strokes of a letter).
void drawText(render::Image& image, double x, double baseline_y, double line_px, std::string_view text, Rgb color);

// Blends a rectangle over the picture; edges may lie within pixels. alpha 0..1.
void fillRectangle(render::Image& image, double left, double top, double right, double bottom, Rgb color, double alpha);

}  // namespace tet4d::host
