// The panels about what a surface is made of and what stands around it.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "player/host/panels.h"

namespace tet4d::host {
namespace {

constexpr float kNumberWidth = 150;

struct Lighting {
  const char* name;
  std::array<std::array<double, 6>, 3> lights;  // direction, colour
  double ambient;
};

// The first is defaultShot()'s.
constexpr std::array<Lighting, 4> kLightings{{
    {"studio",
     {{{0.75, 0.55, -1.0, 0.80, 0.77, 0.71},
       {-1.0, 0.35, -0.25, 0.16, 0.19, 0.24},
       {-0.1, -1.0, -0.45, 0.20, 0.21, 0.23}}},
     0.20},
    {"soft",
     {{{0.3, 0.4, -1.0, 0.42, 0.42, 0.42}, {-1.0, 0.2, -0.4, 0.26, 0.26, 0.26}, {0.6, -0.8, -0.3, 0.22, 0.22, 0.22}}},
     0.32},
    {"low sun",
     {{{1.0, 0.35, -0.22, 1.05, 0.83, 0.58},
       {-0.4, 0.2, -1.0, 0.10, 0.14, 0.24},
       {-1.0, -0.6, -0.2, 0.05, 0.06, 0.09}}},
     0.10},
    {"overhead",
     {{{0.05, 0.08, -1.0, 0.95, 0.95, 0.93}, {-0.6, 1.0, -0.2, 0.14, 0.14, 0.15}, {0.6, -1.0, -0.2, 0.10, 0.10, 0.11}}},
     0.14},
}};

void useLighting(const Lighting& lighting, scene::Shot& shot) {
  shot.lights.clear();
  for (const auto& l : lighting.lights) shot.lights.push_back({{l[0], l[1], l[2]}, {l[3], l[4], l[5]}});
  shot.ambient = glm::dvec3(lighting.ambient);
}

struct Glass {
  const char* name;
  double index;
};
constexpr std::array<Glass, 4> kGlasses{{{"water", 1.333}, {"glass", 1.52}, {"flint", 1.75}, {"diamond", 2.42}}};

void tip(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

bool slide(const char* label, double& value, float low, float high, const char* format, ImGuiSliderFlags flags = 0) {
  auto number = static_cast<float>(value);
  ImGui::SetNextItemWidth(kNumberWidth);
  if (!ImGui::SliderFloat(label, &number, low, high, format, flags | ImGuiSliderFlags_AlwaysClamp)) return false;
  value = double{number};
  return true;
}

// Refraction: off, or an index with what belongs to it.
bool editRefraction(ViewerState& state, scene::Material& material) {
  bool changed = false, is_clear = material.refraction > 0;
  if (ImGui::Checkbox("transparent", &is_clear)) {
    material.refraction = is_clear ? kGlasses[0].index : 0;
    changed = true;
  }
  markPlace(state, "transparent");
  tip("seen through, as water or glass: light is bent by its index");
  if (!is_clear) return changed;
  const Glass* known = std::find_if(kGlasses.begin(), kGlasses.end(), [&](const Glass& glass) {
    return std::abs(glass.index - material.refraction) < 5e-4;
  });
  ImGui::SameLine(130);
  ImGui::SetNextItemWidth(80);
  if (ImGui::BeginCombo("as", known == kGlasses.end() ? "..." : known->name)) {
    for (const Glass& glass : kGlasses) {
      if (!ImGui::Selectable(glass.name, &glass == known)) continue;
      material.refraction = glass.index;
      changed = true;
    }
    ImGui::EndCombo();
  }
  changed |= slide("index", material.refraction, 1, 3, "%.3f");
  markPlace(state, "index");
  tip("of refraction: 1 bends nothing, water 1.333, glass 1.52");
  changed |= slide("tint", material.tint, 0, 1, "%.2f");
  markPlace(state, "tint");
  tip("how much of the light takes the surface's colour");
  changed |= slide("depth", material.depth, 0, 4, "%.2f");
  markPlace(state, "depth");
  tip("how far behind the surface the background stands,\nin radii of the data's box");
  int checker = static_cast<int>(state.shot.background.checker);
  ImGui::SetNextItemWidth(kNumberWidth);
  if (ImGui::SliderInt("checker", &checker, 0, 40, "%d", ImGuiSliderFlags_AlwaysClamp)) {
    state.shot.background.checker = static_cast<unsigned>(checker);
    if (!state.shot.background.room) toggleRoom(state.shot.background);
    changed = true;
  }
  markPlace(state, "checker");
  tip("squares on the walls behind, to see light bend; 0: none");
  return changed;
}

}  // namespace

bool editColor(const char* label, glm::dvec3& color) {
  std::array<float, 3> rgb{static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z)};
  if (!ImGui::ColorEdit3(label, rgb.data(), ImGuiColorEditFlags_NoInputs)) return false;
  color = {double{rgb[0]}, double{rgb[1]}, double{rgb[2]}};
  return true;
}

void layOutMaterial(Viewer& viewer) {
  ViewerFile* file = viewer.selected();
  if (file == nullptr) return ImGui::TextDisabled("open a file first");
  bool changed = slide("highlight", file->material.specular, 0, 1, "%.2f");
  changed |= slide("sharpness", file->material.shininess, 1, 200, "%.0f", ImGuiSliderFlags_Logarithmic);
  changed |= editRefraction(viewer.state(), file->material);
  if (changed) viewer.changed();
}

void layOutBackground(Viewer& viewer) {
  scene::Shot& shot = viewer.state().shot;
  bool changed = editColor("sky", shot.background.top);
  ImGui::SameLine(130);
  changed |= editColor("ground", shot.background.bottom);
  bool has_room = shot.background.room.has_value();
  if (ImGui::Checkbox("walls", &has_room)) viewer.act(Action::kRoom);
  markPlace(viewer.state(), "walls");
  if (shot.background.room) {
    ImGui::SameLine(130);
    changed |= editColor("their colour", *shot.background.room);
    int checker = static_cast<int>(shot.background.checker);
    ImGui::SetNextItemWidth(kNumberWidth);
    if (ImGui::SliderInt("squares", &checker, 0, 40, "%d", ImGuiSliderFlags_AlwaysClamp)) {
      shot.background.checker = static_cast<unsigned>(checker);
      changed = true;
    }
    tip("of a checker on the walls; 0: plain");
  }
  ImGui::SetNextItemWidth(kNumberWidth);
  const auto* present = std::find_if(kLightings.begin(), kLightings.end(), [&](const Lighting& lighting) {
    scene::Shot other = shot;
    useLighting(lighting, other);
    return shot.ambient == other.ambient && shot.lights.size() == 3 && shot.lights[0].color == other.lights[0].color;
  });
  if (ImGui::BeginCombo("light", present == kLightings.end() ? "as given" : present->name)) {
    for (const Lighting& lighting : kLightings) {
      if (!ImGui::Selectable(lighting.name, &lighting == present)) continue;
      useLighting(lighting, shot);
      changed = true;
    }
    ImGui::EndCombo();
  }
  if (changed) viewer.changed();
}

void toggleRoom(scene::Background& background) {
  if (background.room) return background.room.reset();
  const bool is_dark = background.top.x + background.bottom.x < 1;
  background.room = is_dark ? glm::dvec3(0.16, 0.18, 0.21) : *scene::Background{}.room;
}

void toggleDark(scene::Background& background) {
  const bool is_dark = background.top.x + background.bottom.x < 1, has_room = background.room.has_value();
  background = is_dark ? scene::Background{} : scene::Background{{0.10, 0.12, 0.15}, {0.20, 0.23, 0.27}, {}};
  if (background.room.has_value() != has_room) toggleRoom(background);
}

}  // namespace tet4d::host
