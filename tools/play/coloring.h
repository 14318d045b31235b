// tet4d-play --color, --color-by, --range, --scale, --map, --shading: what a picture is coloured by.
#pragma once

#include <string>

#include "player/scene/coloring.h"
#include "tools/common/cli.h"

namespace tet4d::play {

struct ColoringOptions {
  std::string color;              // NAME, NAME:COMPONENT from 0, or NAME:magnitude; empty: the material's colours
  std::string by = "auto";        // auto: by the column, if one is named; part
  std::string range;              // LO:HI; empty: 98 % of the file's values
  std::string map = "viridis";    // of colorMaps()
  std::string scale = "linear";   // or log
  std::string shading = "slice";  // slice, file, flat or none
  bool reverse_map = false;
  bool legend = false;
};

// What is asked for, of `file`; `path` stands for it in messages. Throws Error (kUsage) that names the nearest column
// if `color` names none, or the columns there are.
scene::Coloring coloringOf(const ColoringOptions& options, const std::string& path, const dyntri::File& file);

// Colours the file for a film. Without a range all pages of the column are read, one at a time, and what was found is
// noted.
void applyColoring(cli::Session& session, const ColoringOptions& options, const std::string& path,
                   scene::SceneFile& file);

}  // namespace tet4d::play
