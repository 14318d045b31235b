#include "player/scene/scene_files.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>

#include "formats/core/coordinates.h"

namespace tet4d::scene {
namespace {

WorldBox boxOf(const SceneFile& file) {
  return worldBox(file.file->header().index_to_world, file.file->header().bounds);
}

// Of the files after the first, told apart by eye also where colours are hard to see: sRGB, front and back.
constexpr std::array<std::array<double, 6>, 6> kPalette{{
    {0.85, 0.53, 0.20, 0.66, 0.45, 0.27},
    {0.36, 0.62, 0.34, 0.34, 0.49, 0.33},
    {0.69, 0.42, 0.66, 0.55, 0.39, 0.53},
    {0.80, 0.33, 0.30, 0.62, 0.33, 0.31},
    {0.80, 0.70, 0.30, 0.62, 0.56, 0.32},
    {0.45, 0.47, 0.52, 0.38, 0.40, 0.44},
}};

}  // namespace

WorldBox sceneBox(std::span<const SceneFile> files) {
  if (files.empty()) return worldBox({}, {});
  if (files.size() == 1) return boxOf(files[0]);
  glm::dvec3 low(0), high(0);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const WorldBox box = boxOf(files[i]);
    for (std::size_t c = 0; c < box.corners.size(); ++c) {
      const glm::dvec3 corner = box.centre + box.corners[c];
      low = i + c == 0 ? corner : glm::min(low, corner);
      high = i + c == 0 ? corner : glm::max(high, corner);
    }
  }
  WorldBox all;
  all.centre = 0.5 * low + 0.5 * high;
  for (unsigned i = 0; i < 8; ++i) {
    all.corners[i] =
        glm::dvec3((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z) -
        all.centre;
  }
  return all;
}

std::vector<double> sceneTimes(std::span<const SceneFile> files) {
  std::vector<double> times;
  for (const SceneFile& file : files) times.insert(times.end(), file.file->times().begin(), file.file->times().end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

std::optional<float> frameAt(const dyntri::File& file, double time) {
  const auto times = file.times();
  const double slack = 1e-9 * (times.back() - times.front());
  if (!(time >= times.front() - slack && time <= times.back() + slack)) return std::nullopt;
  return sliceFrame(frameOfTime(times, time));
}

Material materialOf(std::span<const SceneFile> files, std::size_t i, const Shot& shot) {
  if (files[i].material) return *files[i].material;
  Material material = shot.material;
  if (i > 0) {
    const auto& color = kPalette[(i - 1) % kPalette.size()];
    material.color = {color[0], color[1], color[2]};
    material.back_color = {color[3], color[4], color[5]};
  }
  return material;
}

DrawList makeDrawList(std::span<const SceneFile> files, const Shot& shot, const Format& format, bool smooth) {
  const WorldBox box = sceneBox(files);
  DrawList list = makeCamera(box, shot, format, smooth);
  for (std::size_t i = 0; i < files.size(); ++i) {
    list.surfaces.push_back(makeSurface(boxOf(files[i]), box.centre, materialOf(files, i, shot)));
    list.surfaces.back().source = i;
    list.surfaces.back().column = files[i].column;
    list.surfaces.back().normal_column = files[i].normal_column;
    list.surfaces.back().lit = files[i].lit;
  }
  return list;
}

std::vector<std::size_t> columnsOf(const SceneFile& file) {
  std::vector<std::size_t> columns;
  if (file.column && !file.column->of_parts) columns.push_back(file.column->column);
  if (file.normal_column && (columns.empty() || columns[0] != *file.normal_column))
    columns.push_back(*file.normal_column);
  return columns;
}

}  // namespace tet4d::scene
