#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>

#include "player/host/panels.h"

namespace tet4d::host {
namespace {

constexpr int kNumberWidth = 150;

std::string shortName(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  if (name.size() > 24) name = name.substr(0, 11) + "..." + name.substr(name.size() - 10);
  return name;
}

// For those who do not drop files.
void openByPath(Viewer& viewer) {
  auto& path = viewer.state().path_to_open;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - 50);
  bool wanted = ImGui::InputTextWithHint("##path", "path of a film (.t4d)", path.data(), path.size(),
                                         ImGuiInputTextFlags_EnterReturnsTrue);
  markPlace(viewer.state(), "path");
  ImGui::SameLine(0, 6);
  wanted |= ImGui::Button("open", {ImGui::GetContentRegionAvail().x, 0});
  markPlace(viewer.state(), "open");
  if (!wanted || path[0] == '\0') return;
  if (Status status = viewer.open(path.data()); !status.ok()) return viewer.report(status.fault());
  path.fill('\0');
}

void filesPart(Viewer& viewer) {
  ViewerState& state = viewer.state();
  openByPath(viewer);
  if (viewer.files().count() == 0) return ImGui::TextDisabled("or drop .t4d files on the window");
  std::size_t removed = std::numeric_limits<std::size_t>::max();
  const auto& files = viewer.files().all();
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i] == nullptr) continue;
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Checkbox("##shown", &files[i]->shown)) viewer.changed();
    markPlace(state, ("shown " + std::to_string(i)).c_str());
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("show or hide");
    ImGui::SameLine();
    const glm::dvec3 color = files[i]->material.color;
    ImGui::ColorButton("##color",
                       {static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z), 1},
                       ImGuiColorEditFlags_NoTooltip, {14, 19});
    ImGui::SameLine();
    if (ImGui::Selectable(shortName(files[i]->path).c_str(), state.selected == i, 0, {170, 0})) state.selected = i;
    markPlace(state, ("name " + std::to_string(i)).c_str());
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s\n%llu triangles", files[i]->path.c_str(),
                        static_cast<unsigned long long>(files[i]->file.header().triangles));
    ImGui::SameLine();
    if (ImGui::SmallButton("x")) removed = i;
    markPlace(state, ("remove " + std::to_string(i)).c_str());
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("close this file");
    ImGui::PopID();
  }
  if (removed < files.size()) viewer.removeFile(removed);
}

// Of `count` buttons in a row, `gap` apart.
float buttonWidth(int count, float gap) {
  return (ImGui::GetContentRegionAvail().x - static_cast<float>(count - 1) * gap) / static_cast<float>(count);
}

void viewPart(Viewer& viewer) {
  const float width = buttonWidth(4, 4);
  const auto button = [&](const char* label, Action action, bool same_line) {
    if (same_line) ImGui::SameLine(0, 4);
    if (ImGui::Button(label, {width, 0})) viewer.act(action);
  };
  button("front", Action::kFront, false);
  button("right", Action::kRight, true);
  button("top", Action::kTop, true);
  button("3/4", Action::kThreeQuarter, true);
  button("back", Action::kBack, false);
  button("left", Action::kLeft, true);
  button("bottom", Action::kBottom, true);
  button("fit", Action::kFit, true);
  bool ortho = viewer.state().shot.view.ortho_height.has_value();
  if (ImGui::Checkbox("orthographic", &ortho)) viewer.act(Action::kProjection);
}

void row(const char* name, const std::string& value) {
  ImGui::TextDisabled("%s", name);
  ImGui::SameLine(110);
  ImGui::TextUnformatted(value.c_str());
}

void budgetPart(Viewer& viewer) {
  ViewerState& state = viewer.state();
  auto budget = static_cast<float>(state.budget_ms);
  ImGui::SetNextItemWidth(kNumberWidth);
  if (ImGui::SliderFloat("ms moving", &budget, 5, 500, "%.0f", ImGuiSliderFlags_Logarithmic)) {
    viewer.setBudget(double{budget}, state.samples);
  }
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip(
        "While something moves, a picture that takes longer\nis drawn with fewer samples, or smaller and stretched.");
  }
  ImGui::SetNextItemWidth(kNumberWidth);
  if (ImGui::BeginCombo("samples at rest", std::to_string(state.samples).c_str())) {
    for (const std::uint32_t samples : {1u, 4u, 9u, 16u}) {
      if (!ImGui::Selectable(std::to_string(samples).c_str(), samples == state.samples)) continue;
      viewer.setBudget(state.budget_ms, samples);
    }
    ImGui::EndCombo();
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%u samples, 1/%u size", state.quality.samples, state.quality.divide);
  row("this picture", text.data());
  std::snprintf(text.data(), text.size(), "%.1f ms, p95 %.1f ms", state.budget.p50_ms, state.budget.p95_ms);
  row("pictures", text.data());
}

std::string grouped(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ' ';
    text += digits[i];
  }
  return text;
}

std::string bytesText(std::uint64_t bytes) {
  std::array<char, 32> text{};
  const auto b = static_cast<double>(bytes);
  if (bytes < 1'000'000) {
    std::snprintf(text.data(), text.size(), "%.1f kB", b / 1e3);
  } else if (bytes < 1'000'000'000) {
    std::snprintf(text.data(), text.size(), "%.1f MB", b / 1e6);
  } else {
    std::snprintf(text.data(), text.size(), "%.2f GB", b / 1e9);
  }
  return text.data();
}

void statisticsPart(Viewer& viewer) {
  const ViewerState& state = viewer.state();
  const SceneStats& stats = state.stats;
  float highest = 1;
  for (const float ms : state.frame_ms) highest = std::max(highest, ms);
  std::array<char, 40> label{};
  std::snprintf(label.data(), label.size(), "%.1f ms", stats.ms);
  ImGui::PlotLines("##ms", state.frame_ms.data(), static_cast<int>(state.frame_ms.size()), 0, label.data(), 0,
                   1.15f * highest, {ImGui::GetContentRegionAvail().x, 42});
  row("drawn", grouped(stats.drawn) + " triangles");
  std::array<char, 48> ratio{};
  std::snprintf(ratio.data(), ratio.size(), "%.2f x drawn",
                stats.drawn > 0 ? static_cast<double>(stats.processed) / static_cast<double>(stats.drawn) : 1.0);
  row("processed", ratio.data());
  row("of all", grouped(viewer.files().triangles()));
  row("pages alive",
      grouped(stats.pages_active) + (stats.pages_waiting > 0 ? ", loading " + grouped(stats.pages_waiting) : ""));
  row("read", bytesText(stats.bytes_touched));
  if (const std::uint64_t scanned = viewer.files().scannedBytes(); scanned > 0)
    row("scanned", bytesText(scanned) + " for ranges");
  row("in memory", bytesText(stats.resident_bytes));
  if (stats.pages_damaged > 0) row("damaged", grouped(stats.pages_damaged) + " pages left out");
}

// A film runs as it was seen, until another rate is asked for.
void filmRate(Viewer& viewer) {
  ViewerState& state = viewer.state();
  auto fps = static_cast<float>(viewer.filmFps());
  ImGui::SetNextItemWidth(kNumberWidth);
  if (ImGui::SliderFloat("a second", &fps, static_cast<float>(Viewer::kLeastFps), static_cast<float>(Viewer::kMostFps),
                         "%.4g", ImGuiSliderFlags_Logarithmic))
    state.film_fps = double{fps};
  markPlace(state, "film fps");
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip(state.film_fps ? "pictures a second of the film"
                                     : "pictures a second of the film: as fast as it is played here");
  }
  if (!state.film_fps) return;
  if (ImGui::SmallButton("as played")) state.film_fps.reset();
  markPlace(state, "as played");
}

void savePart(Viewer& viewer) {
  const float width = buttonWidth(3, 8);
  ViewerState& state = viewer.state();
  if (ImGui::Button("picture", {width, 0})) viewer.act(Action::kSavePicture);
  markPlace(state, "save picture");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("the picture without panels, as PNG (s)");
  ImGui::SameLine(0, 8);
  const Recorder* recorder = viewer.recorder();
  if (ImGui::Button(recorder != nullptr ? "stop" : "film", {width, 0})) viewer.act(Action::kFilm);
  markPlace(state, "film");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("the range of the time line (v)");
  ImGui::SameLine(0, 8);
  if (ImGui::Button("camera", {width, 0})) viewer.act(Action::kWriteCamera);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("for --camera (w)");
  if (viewer.recorder() != nullptr) {
    recorder = viewer.recorder();
    const std::string text = std::to_string(recorder->taken()) + " of " + std::to_string(recorder->count());
    ImGui::ProgressBar(static_cast<float>(recorder->taken()) / static_cast<float>(recorder->count()),
                       {ImGui::GetContentRegionAvail().x, 0}, text.c_str());
    return;
  }
  const bool has_options = ImGui::TreeNode("film options");
  markPlace(state, "film options");
  if (!has_options) return;
  ImGui::SetNextItemWidth(kNumberWidth);
  if (ImGui::BeginCombo("film as", state.film_kind == FilmKind::kPng ? "PNG pictures" : "y4m")) {
    if (ImGui::Selectable("PNG pictures", state.film_kind == FilmKind::kPng)) state.film_kind = FilmKind::kPng;
    if (ImGui::Selectable("y4m", state.film_kind == FilmKind::kY4m)) state.film_kind = FilmKind::kY4m;
    ImGui::EndCombo();
  }
  ImGui::SetNextItemWidth(kNumberWidth);
  ImGui::SliderInt("in between", &state.film_between, 0, 9);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("pictures between two frames of the data");
  if (state.film_kind == FilmKind::kY4m) filmRate(viewer);
  ImGui::TreePop();
}

}  // namespace

void layOutSide(Viewer& viewer, const PanelLayout& layout) {
  ImGui::TextDisabled("press ? for all keys");
  const auto part = [&](const char* title, bool open, void (*body)(Viewer&)) {
    const bool is_open = ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    markPlace(viewer.state(), title);
    if (is_open) body(viewer);
  };
  // What does not fit at first is one click away rather than below the end.
  part("Files", true, filesPart);
  part("Save", true, savePart);
  part("Colours", true, layOutColors);
  part("Columns", layout.height >= 640, layOutColumns);
  part("Material", false, layOutMaterial);
  part("Background", false, layOutBackground);
  part("View", layout.height >= 780, viewPart);
  part("Statistics", layout.height >= 900, statisticsPart);
  part("Budget", layout.height >= 1080, budgetPart);
}

}  // namespace tet4d::host
