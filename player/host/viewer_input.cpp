// What hands do to a viewer: events of pointer, wheel, keys and window, and what they mean in the picture.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "player/host/panels.h"
#include "player/host/viewer.h"

namespace tet4d::host {
namespace {

constexpr double kTurnDegreesPerUnit = 0.4;  // of a drag
constexpr double kZoomPerNotch = 0.88;

}  // namespace

// Which of our keys its widgets know by which number.
void Viewer::mapKeys() {
  ImGuiIO& io = ImGui::GetIO();
  const std::pair<ImGuiKey_, Key> pairs[] = {
      {ImGuiKey_LeftArrow, Key::kLeft},      {ImGuiKey_RightArrow, Key::kRight}, {ImGuiKey_UpArrow, Key::kUp},
      {ImGuiKey_DownArrow, Key::kDown},      {ImGuiKey_Home, Key::kHome},        {ImGuiKey_End, Key::kEnd},
      {ImGuiKey_Escape, Key::kEscape},       {ImGuiKey_Tab, Key::kTab},          {ImGuiKey_Enter, Key::kEnter},
      {ImGuiKey_Backspace, Key::kBackspace}, {ImGuiKey_Delete, Key::kDelete}};
  for (const auto& [gui, key] : pairs) io.KeyMap[gui] = static_cast<int>(key);
}

void Viewer::handle(Event event) { events_.push_back(std::move(event)); }

void Viewer::takeEvents() {
  // The panels see one press or release at a time, or a quick click would be none.
  while (!events_.empty()) {
    const Event event = std::move(events_.front());
    events_.pop_front();
    takeEvent(event);
    if (std::holds_alternative<PointerButton>(event)) return;
  }
}

void Viewer::takeEvent(const Event& event) {
  ImGuiIO& io = ImGui::GetIO();
  if (const auto* moved = std::get_if<PointerMoved>(&event)) return pointerMoved(*moved);
  if (const auto* key = std::get_if<KeyChanged>(&event)) return keyChanged(*key);
  if (const auto* size = std::get_if<Resized>(&event)) return resized(*size);
  if (const auto* button = std::get_if<PointerButton>(&event)) {
    if (button->button < 0 || button->button > 2) return;
    state_.is_new = false;
    io.MouseDown[button->button] = button->down;
    button_ = *button;
    if (!button->down) drag_ = Drag::kNone;
  } else if (const auto* wheel = std::get_if<Scrolled>(&event)) {
    wheel_ += wheel->by;
    state_.is_new = false;
    io.MouseWheel += static_cast<float>(wheel->by);
  } else if (const auto* typed = std::get_if<Typed>(&event)) {
    io.AddInputCharacter(typed->character);
    if (io.WantTextInput) return;
    if (const KeyBinding* binding = bindingOf(typed->character)) act(binding->action);
  } else if (const auto* dropped = std::get_if<Dropped>(&event)) {
    for (const std::string& path : dropped->paths) {
      if (Status status = open(path); !status.ok()) report(status.fault());
    }
  }
}

void Viewer::pointerMoved(const PointerMoved& event) {
  ImGui::GetIO().MousePos = {static_cast<float>(event.x), static_cast<float>(event.y)};
  const glm::dvec2 before = pointer_;
  pointer_ = glm::dvec2(event.x, event.y) * state_.scale;
  if (drag_ == Drag::kNone || pointer_ == before) return;
  scene::View& view = state_.shot.view;
  if (drag_ == Drag::kTurn) {
    const glm::dvec2 by = (pointer_ - before) / state_.scale * kTurnDegreesPerUnit;
    view = scene::turn(view, box_.centre, -by.x, by.y);
  } else {
    view = scene::pan(view, pictureSize(), box_.centre, before, pointer_);
  }
  moved_by_hand_ = scene_changed_ = true;
}

void Viewer::keyChanged(const KeyChanged& event) {
  ImGuiIO& io = ImGui::GetIO();
  io.KeysDown[static_cast<int>(event.key)] = event.down;
  io.KeyCtrl = event.control;
  io.KeyShift = event.shift;
  if (!event.down || io.WantTextInput) return;
  if (const KeyBinding* binding = bindingOf(event.key)) act(binding->action);
}

void Viewer::resized(const Resized& event) {
  state_.width = event.width;
  state_.height = event.height;
  if (event.scale > 0 && !options_.fixed_scale) rescale(event.scale);
  scene_changed_ = true;
  if (event.width == 0 || event.height == 0 || moved_by_hand_ || options_.shot || files_.count() == 0) return;
  state_.shot.view = scene::fit(state_.shot.view, pictureSize(), fitFrame(), box_);
}

// Letters are drawn at the framebuffer's own resolution: another scale, other letters.
void Viewer::rescale(double scale) {
  if (scale == state_.scale) return;
  state_.scale = scale;
  stylePanels(scale);
  if (canvas_ != nullptr) canvas_->uploadFonts();
}

// What the pointer does in the picture, once the panels have said whether it is theirs.
void Viewer::pointInPicture() {
  const bool theirs = ImGui::GetIO().WantCaptureMouse;
  if (button_ && button_->down && !theirs) {
    drag_ = button_->button == 0 && !button_->shift ? Drag::kTurn : Drag::kPan;
  }
  button_.reset();
  if (wheel_ != 0 && !theirs && files_.count() > 0) {
    state_.shot.view = scene::zoom(state_.shot.view, pictureSize(), box_, box_.centre, pointer_,
                                   std::pow(kZoomPerNotch, std::clamp(wheel_, -20.0, 20.0)));
    moved_by_hand_ = scene_changed_ = true;
    wheeled_s_ = 0;
  }
  wheel_ = 0;
}

}  // namespace tet4d::host
