// tet4d-play --color, --range, --map, --shading: which columns of a file a picture is drawn with.
#pragma once

#include <string>

#include "player/scene/scene_files.h"
#include "tools/common/cli.h"

namespace tet4d::play {

struct Coloring {
  std::string color;              // NAME, NAME:COMPONENT from 0, or NAME:magnitude; empty: the material's colours
  std::string range;              // LO:HI; empty: from the smallest to the largest finite value of the file
  std::string map = "viridis";    // of colorMaps()
  std::string shading = "slice";  // slice, file or flat
};

// Sets the file's columns. Without a range all pages of the column are read, one at a time. Throws Error (kUsage) that
// names the nearest column if `color` names none, or the columns there are. `path` stands for the file.
void applyColoring(cli::Session& session, const Coloring& coloring, const std::string& path, scene::SceneFile& file);

}  // namespace tet4d::play
