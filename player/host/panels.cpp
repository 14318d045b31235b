#include "player/host/panels.h"

#include <imgui.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace tet4d::host {
namespace {

constexpr double kGap = 12, kSideWidth = 276, kBarHeight = 84, kTallBarHeight = 112;
constexpr double kWideBar = 1080;  // all buttons in one row
constexpr double kLeastWidthForSide = 640, kLeastHeightForSide = 300, kLeastWidthForBar = 420, kLeastHeightForBar = 160;
constexpr float kFontUnits = 13;

ImVec2 vec(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                                    ImGuiWindowFlags_NoNav;

}  // namespace

void stylePanels(double scale) {
  ImGui::GetStyle() = ImGuiStyle();
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.PopupRounding = 4;
  style.ScrollbarSize = 10;
  style.WindowBorderSize = 0;
  style.FrameBorderSize = 1;
  style.WindowPadding = {10, 10};
  style.FramePadding = {6, 3};
  style.ItemSpacing = {7, 5};
  const auto set = [&](ImGuiCol which, float r, float g, float b, float a) { style.Colors[which] = {r, g, b, a}; };
  set(ImGuiCol_WindowBg, 0.07f, 0.085f, 0.105f, 0.86f);
  set(ImGuiCol_PopupBg, 0.07f, 0.085f, 0.105f, 0.97f);
  set(ImGuiCol_Text, 0.90f, 0.92f, 0.94f, 1);
  set(ImGuiCol_TextDisabled, 0.55f, 0.60f, 0.65f, 1);
  set(ImGuiCol_FrameBg, 0.18f, 0.21f, 0.25f, 0.9f);
  set(ImGuiCol_FrameBgHovered, 0.24f, 0.29f, 0.35f, 1);
  set(ImGuiCol_FrameBgActive, 0.28f, 0.35f, 0.43f, 1);
  set(ImGuiCol_Header, 0.17f, 0.22f, 0.28f, 0.9f);
  set(ImGuiCol_HeaderHovered, 0.22f, 0.30f, 0.38f, 1);
  set(ImGuiCol_HeaderActive, 0.25f, 0.36f, 0.46f, 1);
  set(ImGuiCol_Button, 0.19f, 0.25f, 0.31f, 1);
  set(ImGuiCol_ButtonHovered, 0.25f, 0.40f, 0.52f, 1);
  set(ImGuiCol_ButtonActive, 0.28f, 0.50f, 0.66f, 1);
  set(ImGuiCol_SliderGrab, 0.36f, 0.62f, 0.80f, 1);
  set(ImGuiCol_SliderGrabActive, 0.48f, 0.75f, 0.93f, 1);
  set(ImGuiCol_CheckMark, 0.48f, 0.75f, 0.93f, 1);
  set(ImGuiCol_PlotLines, 0.48f, 0.75f, 0.93f, 1);
  set(ImGuiCol_Border, 0.36f, 0.41f, 0.46f, 0.55f);
  set(ImGuiCol_Separator, 0.30f, 0.35f, 0.40f, 0.6f);
  // Drawn at the framebuffer's own resolution, laid out in units.
  ImFontConfig font;
  font.SizePixels = kFontUnits * static_cast<float>(std::clamp(scale, 0.5, 8.0));
  ImGui::GetIO().Fonts->Clear();
  ImGui::GetIO().Fonts->AddFontDefault(&font);
  ImGui::GetIO().FontGlobalScale = kFontUnits / font.SizePixels;
}

PanelLayout panelLayout(const ViewerState& state) {
  PanelLayout layout;
  layout.width = state.width / state.scale;
  layout.height = state.height / state.scale;
  layout.side = state.panels && layout.width >= kLeastWidthForSide && layout.height >= kLeastHeightForSide;
  layout.bar = state.panels && layout.width >= kLeastWidthForBar && layout.height >= kLeastHeightForBar;
  layout.side_right = kGap + kSideWidth;
  layout.bar_is_tall = layout.width < kWideBar;
  layout.bar_top = layout.height - kGap - (layout.bar_is_tall ? kTallBarHeight : kBarHeight);
  return layout;
}

void markPlace(ViewerState& state, const char* name) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  state.places[name] = {double{low.x}, double{low.y}, double{high.x} - double{low.x}, double{high.y} - double{low.y}};
}

void layOutPanels(Viewer& viewer) {
  const PanelLayout layout = panelLayout(viewer.state());
  viewer.state().places.clear();
  if (layout.side) {
    ImGui::SetNextWindowPos(vec(kGap, kGap));
    ImGui::SetNextWindowSizeConstraints(vec(kSideWidth, 40), vec(kSideWidth, layout.bar_top - 2 * kGap));
    constexpr ImGuiWindowFlags kSide = (kFixed & ~ImGuiWindowFlags_NoScrollbar) | ImGuiWindowFlags_AlwaysAutoResize;
    if (ImGui::Begin("side", nullptr, kSide)) layOutSide(viewer, layout);
    ImGui::End();
  }
  if (layout.bar) {
    ImGui::SetNextWindowPos(vec(kGap, layout.bar_top));
    ImGui::SetNextWindowSize(vec(layout.width - 2 * kGap, layout.height - kGap - layout.bar_top));
    if (ImGui::Begin("bar", nullptr, kFixed | ImGuiWindowFlags_NoScrollWithMouse)) layOutBar(viewer, layout);
    ImGui::End();
  }
  if (viewer.state().panels) layOutHint(viewer, layout);
  if (viewer.state().help) layOutHelp(layout);
  layOutMessages(viewer, layout);
}

void layOutHelp(const PanelLayout& layout) {
  ImGui::SetNextWindowPos(vec(layout.width / 2, layout.height / 2), ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, vec(layout.width - 2 * kGap, layout.height - 2 * kGap));
  ImGui::SetNextWindowBgAlpha(0.95f);
  ImGui::SetNextWindowFocus();
  constexpr ImGuiWindowFlags kHelp = (kFixed & ~ImGuiWindowFlags_NoScrollbar) | ImGuiWindowFlags_AlwaysAutoResize;
  if (!ImGui::Begin("keys", nullptr, kHelp)) return ImGui::End();
  const ImVec4 accent = ImGui::GetStyleColorVec4(ImGuiCol_CheckMark);
  // Two columns of groups: what is about time on the left, the rest on the right.
  if (ImGui::BeginTable("groups", 2, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_PadOuterX)) {
    const char* group = "";
    for (const KeyBinding& binding : keyTable()) {
      if (binding.group != group) {
        const bool is_first = *group == '\0';
        group = binding.group;
        const bool next_column = is_first || std::string_view(group) == "Look";
        if (next_column) ImGui::TableNextColumn();
        if (!next_column) ImGui::Dummy({1, 4});
        ImGui::TextColored(accent, "%s", group);
      }
      ImGui::TextUnformatted(binding.label);
      ImGui::SameLine(54);
      ImGui::TextUnformatted(binding.meaning);
    }
    ImGui::Dummy({1, 4});
    ImGui::TextColored(accent, "Mouse");
    for (const Gesture& gesture : gestures()) ImGui::Text("%s: %s", gesture.label, gesture.meaning);
    ImGui::EndTable();
  }
  ImGui::End();
}

void layOutHint(Viewer& viewer, const PanelLayout& layout) {
  const bool is_empty = viewer.files().count() == 0;
  if (!is_empty && !viewer.state().is_new) return;
  const double left = layout.side ? layout.side_right : 0, bottom = layout.bar ? layout.bar_top : layout.height;
  const char* text = is_empty
                         ? "Drop a film (.t4d) on this window to open it"
                         : "drag: turn    wheel: zoom    Space: play    c: colours    s: save a picture    ?: more";
  const double room = layout.width - left - 2 * kGap;
  if (double{ImGui::CalcTextSize(text).x} + 20 > room)
    text = is_empty ? "Drop a .t4d file here" : "Space: play    s: save    ?: keys";
  if (double{ImGui::CalcTextSize(text).x} + 20 > room) return;
  const double y = is_empty ? bottom / 2 : kGap;
  ImGui::SetNextWindowPos(vec(left + (layout.width - left) / 2, y), ImGuiCond_Always, {0.5f, is_empty ? 0.5f : 0.0f});
  if (ImGui::Begin("hint", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs)) {
    ImGui::TextUnformatted(text);
    const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    viewer.state().places["hint"] = {double{low.x}, double{low.y}, double{size.x}, double{size.y}};
  }
  ImGui::End();
}

double messageSeconds(const Message& message) { return message.is_error ? 12 : 5; }

void layOutMessages(Viewer& viewer, const PanelLayout& layout) {
  std::vector<Message>& messages = viewer.state().messages;
  double bottom = (layout.bar ? layout.bar_top : layout.height) - kGap;
  const double width = std::min(420.0, layout.width - 2 * kGap);
  if (width < 80) return;
  for (std::size_t i = messages.size(); i-- > 0;) {
    const Message& message = messages[i];
    ImGui::SetNextWindowPos(vec(layout.width - kGap, bottom), ImGuiCond_Always, {1, 1});
    ImGui::SetNextWindowSize(vec(width, 0));
    ImGui::PushStyleColor(ImGuiCol_WindowBg,
                          message.is_error ? ImVec4(0.36f, 0.10f, 0.09f, 0.93f) : ImVec4(0.09f, 0.20f, 0.15f, 0.93f));
    const std::string name = "message " + std::to_string(i);
    bool dismissed = false;
    if (ImGui::Begin(name.c_str(), nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize)) {
      ImGui::PushTextWrapPos(0);
      const std::string times = message.count > 1 ? " (" + std::to_string(message.count) + " times)" : "";
      ImGui::TextUnformatted((message.text + times).c_str());
      if (!message.remedy.empty()) ImGui::TextDisabled("%s", message.remedy.c_str());
      ImGui::PopTextWrapPos();
      dismissed = ImGui::IsWindowHovered() && ImGui::IsMouseClicked(0);
      const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
      viewer.state().places[name] = {double{low.x}, double{low.y}, double{size.x}, double{size.y}};
      bottom -= double{size.y} + 6;
    }
    ImGui::End();
    ImGui::PopStyleColor();
    if (dismissed) messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace tet4d::host
