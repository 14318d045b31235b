// The panels about colours: what a file is coloured by, its map and range, and the list of its columns.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "player/host/panels.h"

namespace tet4d::host {
namespace {

constexpr float kFieldWidth = 150, kSecond = 130;
// Columns up to this size are read for the list without being chosen, once their rows are seen.
constexpr std::uint64_t kListedBytes = std::uint64_t{64} << 20;

std::string rangeText(const scene::ColumnSpread& spread) {
  if (spread.values == 0) return "no finite value";
  std::array<char, 64> text{};
  if (spread.isOneValue()) {
    std::snprintf(text.data(), text.size(), "%.4g", double{spread.middle()});
    return text.data();
  }
  std::snprintf(text.data(), text.size(), "%.4g to %.4g", double{spread.least}, double{spread.most});
  return text.data();
}

void tip(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

// ---- what it is coloured by

std::string byName(const ViewerFile& file) {
  switch (file.coloring.by) {
    case scene::ColorBy::kMaterial:
      return "one colour";
    case scene::ColorBy::kPart:
      return "parts";
    default:
      return scene::columnName(file.file, file.coloring.column);
  }
}

bool chooseBy(ViewerState& state, ViewerFile& file) {
  bool changed = false;
  ImGui::SetNextItemWidth(kFieldWidth);
  const bool open = ImGui::BeginCombo("coloured by", byName(file).c_str(), ImGuiComboFlags_HeightLarge);
  markPlace(state, "coloured by");
  if (!open) {
    tip("one colour, a column of the file, or a colour for each part (c: the next)");
    return false;
  }
  const auto choice = [&](const std::string& name, bool is_now) {
    const bool chosen = ImGui::Selectable(name.c_str(), is_now);
    markPlace(state, ("by " + name).c_str());
    changed |= chosen;
    return chosen;
  };
  if (choice("one colour", file.coloring.by == scene::ColorBy::kMaterial)) file.coloring.by = scene::ColorBy::kMaterial;
  if (choice("parts", file.coloring.by == scene::ColorBy::kPart)) file.coloring.by = scene::ColorBy::kPart;
  for (std::size_t c = 0; c < file.file.columns().size(); ++c) {
    const bool is_now = file.coloring.by == scene::ColorBy::kColumn && file.coloring.column == c;
    if (choice(scene::columnName(file.file, c), is_now)) colorByColumn(file, c);
  }
  ImGui::EndCombo();
  return changed;
}

bool chooseComponent(ViewerState& state, ViewerFile& file) {
  const std::uint32_t components = file.file.columns()[file.coloring.column].components;
  if (components == 1) return false;
  constexpr std::array<const char*, 5> kNames{"length", "x", "y", "z", "w"};
  bool changed = false;
  ImGui::SetNextItemWidth(kFieldWidth);
  if (ImGui::BeginCombo("of it", kNames[static_cast<std::size_t>(file.coloring.component + 1)])) {
    for (int component = scene::kMagnitude; component < static_cast<int>(components); ++component) {
      if (!ImGui::Selectable(kNames[static_cast<std::size_t>(component + 1)], component == file.coloring.component))
        continue;
      file.coloring.component = component;
      changed = true;
    }
    ImGui::EndCombo();
  }
  markPlace(state, "component");
  return changed;
}

// ---- the map

ImU32 colorAt(const ColorMap& map, float s, bool reversed) {
  const auto rgb = map.at(reversed ? 1 - s : s);
  return ImGui::ColorConvertFloat4ToU32({rgb[0], rgb[1], rgb[2], 1});
}

// A map as a strip of its colours; true if it was clicked.
bool swatch(const ColorMap& map, bool reversed, bool is_now, const ImVec2& size) {
  const std::string name(map.name);
  const bool clicked = ImGui::InvisibleButton(("map " + name).c_str(), size);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  constexpr int kSteps = 32;
  for (int i = 0; i < kSteps; ++i) {
    const float from = static_cast<float>(i) / kSteps, to = static_cast<float>(i + 1) / kSteps;
    const ImU32 left = colorAt(map, from, reversed), right = colorAt(map, to, reversed);
    draw->AddRectFilledMultiColor({low.x + from * size.x, low.y}, {low.x + to * size.x, high.y}, left, right, right,
                                  left);
  }
  const bool hovered = ImGui::IsItemHovered();
  if (is_now || hovered)
    draw->AddRect({low.x - 1, low.y - 1}, {high.x + 1, high.y + 1},
                  is_now ? IM_COL32(255, 255, 255, 255) : IM_COL32(160, 200, 230, 255), 2, 0, 2);
  if (hovered) ImGui::SetTooltip("%s", name.c_str());
  return clicked;
}

bool chooseMap(ViewerState& state, scene::Coloring& coloring) {
  bool changed = false;
  const float width = (ImGui::GetContentRegionAvail().x - 2 * 8) / 3;
  for (std::size_t i = 0; i < colorMaps().size(); ++i) {
    const ColorMap& map = colorMaps()[i];
    if (i % 3 != 0) ImGui::SameLine(0, 8);
    if (swatch(map, coloring.reversed, coloring.map == &map, {width, 15})) {
      coloring.map = &map;
      changed = true;
    }
    markPlace(state, ("map " + std::string(map.name)).c_str());
  }
  changed |= ImGui::Checkbox("reversed", &coloring.reversed);
  markPlace(state, "reversed");
  tip("the map from its other end");
  ImGui::SameLine(kSecond);
  changed |= ImGui::Checkbox("logarithmic", &coloring.logarithmic);
  markPlace(state, "logarithmic");
  tip("equal steps of colour are equal factors;\nwhat is zero or below takes the lowest colour");
  return changed;
}

// ---- the range

constexpr std::array<std::pair<scene::RangeOf, const char*>, 3> kRanges{{
    {scene::RangeOf::kMost, "98 % of values"},
    {scene::RangeOf::kAll, "all values"},
    {scene::RangeOf::kGiven, "by hand"},
}};

bool editEnds(ViewerState& state, scene::Coloring& coloring, const scene::ColumnSpread* spread) {
  std::array<float, 2> ends{coloring.low, coloring.high};
  const float span =
      spread != nullptr && spread->most > spread->least ? spread->most - spread->least : ends[1] - ends[0];
  ImGui::SetNextItemWidth(kFieldWidth);
  const bool changed = ImGui::DragFloat2("low, high", ends.data(), std::max(span, 1e-20f) / 400, 0, 0, "%.4g");
  markPlace(state, "ends");
  tip("drag, or Ctrl + click to type");
  if (changed) {
    coloring.low = std::min(ends[0], ends[1]);
    coloring.high = std::max(ends[0], ends[1]);
  }
  return changed;
}

bool chooseRange(ViewerState& state, ViewerFile& file) {
  scene::Coloring& coloring = file.coloring;
  const scene::ColumnSpread* spread = file.scans->of(coloring.column, coloring.component);
  bool changed = false;
  ImGui::SetNextItemWidth(kFieldWidth);
  const bool open = ImGui::BeginCombo("range", kRanges[static_cast<std::size_t>(coloring.range)].second);
  markPlace(state, "range");
  if (open) {
    for (const auto& [range, name] : kRanges) {
      const bool chosen = ImGui::Selectable(name, range == coloring.range);
      markPlace(state, ("range " + std::string(name)).c_str());
      if (!chosen || range == coloring.range) continue;
      // By hand begins where it stands.
      const scene::ColorRange present = scene::rangeOf(coloring, spread);
      coloring.low = present.low, coloring.high = present.high;
      coloring.range = range;
      changed = true;
    }
    ImGui::EndCombo();
  }
  if (coloring.range == scene::RangeOf::kGiven) changed |= editEnds(state, coloring, spread);
  if (spread == nullptr) {
    ImGui::TextDisabled("reading the values ...");
  } else if (coloring.logarithmic && spread->least_above_zero == 0 && spread->values > 0) {
    ImGui::TextDisabled("no value above 0: drawn linear");
  } else {
    ImGui::TextDisabled("values: %s", rangeText(*spread).c_str());
  }
  return changed;
}

bool chooseNormals(ViewerState& state, ViewerFile& file, bool& smooth) {
  const auto& columns = file.file.columns();
  const std::string now = !smooth ? "flat"
                          : file.coloring.normal_column
                              ? "column " + scene::columnName(file.file, *file.coloring.normal_column)
                              : "smooth";
  bool changed = false;
  ImGui::SetNextItemWidth(kFieldWidth);
  const bool open = ImGui::BeginCombo("normals", now.c_str());
  markPlace(state, "normals");
  if (!open) {
    tip("what light falls on: smooth, flat triangles (n),\nor a column of the file with three components");
    return false;
  }
  const auto choice = [&](const std::string& name, bool makes_smooth, std::optional<std::size_t> column) {
    const bool chosen = ImGui::Selectable(name.c_str(), name == now);
    markPlace(state, ("normals " + name).c_str());
    if (!chosen) return;
    smooth = makes_smooth;
    file.coloring.normal_column = column;
    changed = true;
  };
  choice("smooth", true, std::nullopt);
  choice("flat", false, std::nullopt);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].components == 3) choice("column " + scene::columnName(file.file, c), true, c);
  }
  ImGui::EndCombo();
  return changed;
}

// ---- the list of columns

std::string stateOf(const ViewerFile& file, std::size_t column) {
  std::size_t loaded = 0;
  const std::size_t pages = file.file.geometryPages();
  for (std::size_t page = 0; page < pages; ++page) loaded += file.pager->residentColumn(page, column).empty() ? 0 : 1;
  if (loaded == 0) return "not loaded";
  return loaded == pages ? "loaded" : std::to_string(loaded) + " of " + std::to_string(pages) + " pages";
}

std::uint64_t storedBytes(const ViewerFile& file, std::size_t column) {
  std::uint64_t bytes = 0;
  for (std::size_t page = 0; page < file.file.geometryPages(); ++page)
    bytes += file.file.pages().entries()[file.file.tablePage(page) + 1 + column].bytes;
  return bytes;
}

std::string kindOf(std::uint32_t components) {
  return components == 1 ? "number" : "vector of " + std::to_string(components);
}

}  // namespace

void colorByColumn(ViewerFile& file, std::size_t column) {
  scene::Coloring& coloring = file.coloring;
  if (column >= file.file.columns().size()) {
    coloring.by = scene::ColorBy::kMaterial;
    return;
  }
  if (coloring.by == scene::ColorBy::kColumn && coloring.column == column) return;
  coloring.by = scene::ColorBy::kColumn;
  coloring.column = column;
  coloring.component = scene::firstComponent(file.file, column);
  coloring.range = scene::RangeOf::kMost;
}

void layOutColors(Viewer& viewer) {
  ViewerFile* file = viewer.selected();
  if (file == nullptr) return ImGui::TextDisabled("open a file first");
  ViewerState& state = viewer.state();
  bool changed = chooseBy(state, *file);
  if (file->coloring.by == scene::ColorBy::kMaterial) {
    changed |= editColor("outside", file->material.color);
    markPlace(state, "outside");
    ImGui::SameLine(kSecond);
    changed |= editColor("inside", file->material.back_color);
  } else {
    if (file->coloring.by == scene::ColorBy::kColumn) {
      changed |= chooseComponent(state, *file);
      changed |= chooseMap(state, file->coloring);
      changed |= chooseRange(state, *file);
    }
    changed |= ImGui::Checkbox("legend", &state.legend);
    markPlace(state, "legend");
    tip("what the colours mean, in the picture (k)");
    ImGui::SameLine(kSecond);
  }
  changed |= ImGui::Checkbox("shading", &file->coloring.lit);
  markPlace(state, "shading");
  tip("light on the surface; without it colours are as they are (u)");
  changed |= chooseNormals(state, *file, state.smooth);
  if (changed) viewer.changed();
}

void layOutColumns(Viewer& viewer) {
  ViewerFile* file = viewer.selected();
  if (file == nullptr) return ImGui::TextDisabled("open a file first");
  const auto& columns = file->file.columns();
  if (columns.empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled("this file has none: tet4d-mc --velocity, --normals, --field write them");
    ImGui::PopTextWrapPos();
    return;
  }
  ViewerState& state = viewer.state();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    ImGui::PushID(static_cast<int>(c));
    const bool is_color = file->coloring.by == scene::ColorBy::kColumn && file->coloring.column == c;
    const std::string name = scene::columnName(file->file, c);
    if (ImGui::Selectable((name + "##column").c_str(), is_color, 0, {150, 0})) {
      colorByColumn(*file, is_color ? columns.size() : c);
      viewer.changed();
    }
    markPlace(state, ("column " + std::to_string(c)).c_str());
    const bool is_seen = ImGui::IsItemVisible();
    tip(is_color ? "click: colours of the material again" : "click: colour the surface by it");
    ImGui::SameLine(166);
    ImGui::TextDisabled("%s", kindOf(columns[c].components).c_str());
    const int component = scene::firstComponent(file->file, c);
    const bool is_asked = is_seen && storedBytes(*file, c) <= kListedBytes;
    const scene::ColumnSpread* spread = is_asked ? file->scans->of(c, component) : file->scans->known(c, component);
    const std::string range = spread != nullptr     ? rangeText(*spread)
                              : file->scans->busy() ? "reading ..."
                                                    : "large: read when chosen";
    const char* of_it = component == scene::kMagnitude ? "length " : columns[c].components > 1 ? "x " : "";
    ImGui::TextDisabled("  %s%s", of_it, range.c_str());
    ImGui::SameLine(166);
    ImGui::TextDisabled("%s", stateOf(*file, c).c_str());
    tip("pages of this column in memory; only what is drawn is read");
    ImGui::PopID();
  }
}

}  // namespace tet4d::host
