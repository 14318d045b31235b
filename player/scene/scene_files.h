// Several files in one scene: one box, one camera, one world time.
//
// Each file keeps its own index space, its table of times and its material; a renderer gets all of them relative to the
// centre of the common box. A file whose times do not hold the present one draws nothing.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "player/scene/draw_list.h"
#include "player/scene/shot.h"
#include "player/scene/world_box.h"

namespace tet4d::scene {

struct SceneFile {
  const dyntri::File* file = nullptr;  // must outlive the scene
  std::optional<Material> material;    // without: the shot's for the first file, a colour of its own for each other
  bool shown = true;
  std::optional<DrawColumn> column = std::nullopt;          // colours by a column of the file, or by part
  std::optional<std::size_t> normal_column = std::nullopt;  // normals of the file in place of the slice's
  bool lit = true;                                          // false: colours as they are
};

// The box of one file as it stands in its index space; of several, along the world's axes around all of them.
WorldBox sceneBox(std::span<const SceneFile> files);

// All frame times of all files, ascending, each once.
std::vector<double> sceneTimes(std::span<const SceneFile> files);

// The frame number of world time `time` in `file`, or nothing if it lies outside the file's table. What lies outside by
// no more than 1e-9 of the table's range counts as its end.
std::optional<float> frameAt(const dyntri::File& file, double time);

// What file `i` is made of in a picture of `shot`.
Material materialOf(std::span<const SceneFile> files, std::size_t i, const Shot& shot);

// Camera and lights, and a surface without items for each file, in order; `source` of a surface is its file's rank.
// `shot` as proved by parseShot() or made by defaultShot().
DrawList makeDrawList(std::span<const SceneFile> files, const Shot& shot, const Format& format, bool smooth);

// The columns that a file is drawn with, each once: what a pager has to bring in beside its pages.
std::vector<std::size_t> columnsOf(const SceneFile& file);

}  // namespace tet4d::scene
