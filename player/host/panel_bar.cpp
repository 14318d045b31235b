#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "player/host/panels.h"

namespace tet4d::host {
namespace {

constexpr float kLineHeight = 26;
constexpr std::size_t kMostTicks = 400;

enum class Icon { kFirst, kBack, kPlay, kPause, kForward, kLast };

// A button with a drawn sign: the font has none of these.
bool iconButton(const char* name, Icon icon, const char* tip) {
  const ImVec2 size{30, 24};
  const bool pressed = ImGui::Button(name, size);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImVec2 low = ImGui::GetItemRectMin();
  const ImVec2 c{low.x + size.x / 2, low.y + size.y / 2};
  const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
  const auto triangle = [&](float x, float way) {
    draw->AddTriangleFilled({x - 4 * way, c.y - 6}, {x - 4 * way, c.y + 6}, {x + 5 * way, c.y}, color);
  };
  const auto post = [&](float x) { draw->AddRectFilled({x - 1.5f, c.y - 6}, {x + 1.5f, c.y + 6}, color); };
  switch (icon) {
    case Icon::kFirst:
      post(c.x - 6);
      triangle(c.x + 1, -1);
      break;
    case Icon::kBack:
      triangle(c.x - 2, -1);
      post(c.x + 6);
      break;
    case Icon::kPlay:
      triangle(c.x, 1.3f);
      break;
    case Icon::kPause:
      draw->AddRectFilled({c.x - 5, c.y - 6}, {c.x - 1.5f, c.y + 6}, color);
      draw->AddRectFilled({c.x + 1.5f, c.y - 6}, {c.x + 5, c.y + 6}, color);
      break;
    case Icon::kForward:
      post(c.x - 6);
      triangle(c.x + 2, 1);
      break;
    case Icon::kLast:
      triangle(c.x - 1, 1);
      post(c.x + 6);
      break;
  }
  return pressed;
}

void drawTicks(const Timeline& timeline, const ImVec2& low, const ImVec2& high,
               float (*at)(const Timeline&, double, const ImVec2&, const ImVec2&)) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const std::vector<double>& table = timeline.table();
  if (table.size() > kMostTicks) return;  // they would run together
  const std::size_t strong = table.size() > 60 ? 10 : 5;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float x = at(timeline, table[i], low, high);
    const bool is_strong = i % strong == 0;
    draw->AddLine({x, high.y - (is_strong ? 10.0f : 6.0f)}, {x, high.y - 2},
                  is_strong ? IM_COL32(190, 200, 210, 210) : IM_COL32(150, 160, 170, 130));
  }
}

float placeOf(const Timeline& timeline, double time, const ImVec2& low, const ImVec2& high) {
  const double span = timeline.last() - timeline.first();
  const double part = span > 0 ? (time - timeline.first()) / span : 0;
  return low.x + static_cast<float>(part) * (high.x - low.x);
}

// Above the line, in the middle over `x`: below stands where time is.
void tell(ViewerState& state, double time, float x, float top) {
  Timeline at = state.timeline;
  at.setTime(time);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "frame %.2f, time %.6g", at.frame(), time);
  const float half = ImGui::CalcTextSize(text.data()).x / 2 + ImGui::GetStyle().WindowPadding.x;
  const float right = std::max(half, ImGui::GetIO().DisplaySize.x - half);
  ImGui::SetNextWindowPos({std::clamp(x, half, right), top - 4}, ImGuiCond_Always, {0.5f, 1});
  ImGui::BeginTooltip();
  ImGui::TextUnformatted(text.data());
  const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  state.places["time told"] = {double{low.x}, double{low.y}, double{size.x}, double{size.y}};
  ImGui::EndTooltip();
}

// Scrubbing: while the mouse holds the line, the time is where it points.
void timeLine(Viewer& viewer, float width) {
  ViewerState& state = viewer.state();
  Timeline& timeline = state.timeline;
  ImGui::InvisibleButton("time line", {std::max(width, 1.0f), kLineHeight});
  markPlace(state, "time line");
  const bool held = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
  constexpr float kInset = 6;
  const ImVec2 low{ImGui::GetItemRectMin().x + kInset, ImGui::GetItemRectMin().y};
  const ImVec2 high{ImGui::GetItemRectMax().x - kInset, ImGui::GetItemRectMax().y};
  const double part = std::clamp(
      (double{ImGui::GetMousePos().x} - double{low.x}) / std::max(1e-3, double{high.x} - double{low.x}), 0.0, 1.0);
  const double pointed = timeline.first() + part * (timeline.last() - timeline.first());
  if (held && viewer.recorder() == nullptr && timeline.time() != pointed) {
    timeline.play(false);
    timeline.setTime(part == 1 ? timeline.last() : pointed);
    viewer.changed();
  }
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled({low.x - kInset, low.y}, {high.x + kInset, high.y}, ImGui::GetColorU32(ImGuiCol_FrameBg), 4);
  const float begin = placeOf(timeline, timeline.begin(), low, high),
              end = placeOf(timeline, timeline.end(), low, high);
  draw->AddRectFilled({begin, low.y + 3}, {std::max(end, begin + 1), high.y - 3}, IM_COL32(70, 120, 155, 110), 3);
  drawTicks(timeline, low, high, placeOf);
  const float x = placeOf(timeline, timeline.time(), low, high);
  const ImU32 color = held ? IM_COL32(255, 255, 255, 255) : IM_COL32(125, 195, 240, 255);
  draw->AddRectFilled({x - 1.5f, low.y + 1}, {x + 1.5f, high.y - 1}, color);
  draw->AddCircleFilled({x, low.y + 5}, 5, color);
  if ((hovered || held) && !timeline.table().empty())
    tell(state, held ? timeline.time() : pointed, ImGui::GetMousePos().x, low.y);
}

void playButtons(Viewer& viewer) {
  ViewerState& state = viewer.state();
  const auto button = [&](const char* name, Icon icon, const char* tip, Action action) {
    if (iconButton(name, icon, tip)) viewer.act(action);
    markPlace(state, name + 2);
    ImGui::SameLine(0, 4);
  };
  const bool playing = state.timeline.playing();
  button("##first", Icon::kFirst, "begin of the range (Home)", Action::kFirst);
  button("##back", Icon::kBack, "frame before (Left)", Action::kStepBack);
  button("##play", playing ? Icon::kPause : Icon::kPlay, playing ? "pause (Space)" : "play (Space)", Action::kPlay);
  button("##forward", Icon::kForward, "next frame (Right)", Action::kStepForward);
  button("##last", Icon::kLast, "end of the range (End)", Action::kLast);
}

// The range that is played and filmed, by mouse.
void rangeButtons(Viewer& viewer) {
  const auto button = [&](const char* name, const char* tip, Action action) {
    if (ImGui::Button(name)) viewer.act(action);
    markPlace(viewer.state(), name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
    ImGui::SameLine(0, 4);
  };
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("range");
  ImGui::SameLine();
  button("from here", "what is played and filmed begins at the present time (i)", Action::kRangeBegin);
  button("to here", "what is played and filmed ends at the present time (o)", Action::kRangeEnd);
  button("all", "the range is everything (a)", Action::kRangeAll);
}

void speedAndLoop(Viewer& viewer, bool is_tight) {
  Timeline& timeline = viewer.state().timeline;
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("speed");
  ImGui::SameLine();
  auto octaves = static_cast<float>(std::log2(timeline.speed()));
  std::array<char, 24> label{};
  std::snprintf(label.data(), label.size(), "x %-5.3g", timeline.speed());
  ImGui::SetNextItemWidth(is_tight ? 66.0f : 90.0f);
  if (ImGui::SliderFloat("##speed", &octaves, -6, 6, ""))
    timeline.setSpeed(std::exp2(std::round(double{octaves} * 2) / 2));
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("x 1: twelve frames a second ([ slower, ] faster)");
  markPlace(viewer.state(), "speed");
  ImGui::SameLine();
  ImGui::TextUnformatted(label.data());
  ImGui::SameLine();
  bool backward = timeline.backward();
  if (ImGui::Checkbox("backward", &backward)) timeline.setBackward(backward);
  markPlace(viewer.state(), "backward");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("play the other way (r)");
  ImGui::SameLine(0, 12);
  ImGui::SetNextItemWidth(102);
  const bool open = ImGui::BeginCombo("##loop", loopName(timeline.loop()));
  markPlace(viewer.state(), "loop");
  if (open) {
    for (const Loop loop : {Loop::kLoop, Loop::kPingPong, Loop::kOnce}) {
      if (ImGui::Selectable(loopName(loop), loop == timeline.loop())) timeline.setLoop(loop);
      markPlace(viewer.state(), loopName(loop));
    }
    ImGui::EndCombo();
  } else if (ImGui::IsItemHovered())
    ImGui::SetTooltip("what happens at the end of the range (l)");
}

}  // namespace

void layOutBar(Viewer& viewer, const PanelLayout& layout) {
  const Timeline& timeline = viewer.state().timeline;
  timeLine(viewer, ImGui::GetContentRegionAvail().x);
  ImGui::Dummy({1, 1});
  playButtons(viewer);
  const auto more = [&] {
    speedAndLoop(viewer, layout.bar_is_tall);
    ImGui::SameLine(0, layout.bar_is_tall ? 8.0f : 16.0f);
    rangeButtons(viewer);
  };
  if (!layout.bar_is_tall) {
    ImGui::SameLine(0, 16);
    more();
  }
  std::array<char, 96> where{};
  if (timeline.table().empty()) {
    std::snprintf(where.data(), where.size(), "nothing is open");
  } else {
    std::snprintf(where.data(), where.size(), "frame %.2f of %zu   time %.6g", timeline.frame(),
                  timeline.table().size() - 1, timeline.time());
  }
  const float width = ImGui::CalcTextSize(where.data()).x;
  ImGui::SameLine(std::max(180.0f, ImGui::GetWindowContentRegionMax().x - width));
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(where.data());
  markPlace(viewer.state(), "where");
  if (layout.bar_is_tall) more();
}

}  // namespace tet4d::host
