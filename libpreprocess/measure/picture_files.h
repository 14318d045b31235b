// Pictures and films that lie in PNG files, compared row by row: memory does not grow with their height, and of a film
// with a row of at most 64 pictures.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libpreprocess/measure/picture_error.h"

namespace tet4d::measure {

// Throws Error: kUsage naming both if they differ in size, else as exchange::PngRows.
PictureError comparePictureFiles(const std::string& picture, const std::string& reference);

// Adds a film to `meter`: pictures in time order and the exact ones, as many. Every picture is decoded once (two in 32
// twice). Throws as above, kUsage if there are not as many.
void addFilm(const std::vector<std::string>& pictures, const std::vector<std::string>& references, FilmMeter& meter);

}  // namespace tet4d::measure
