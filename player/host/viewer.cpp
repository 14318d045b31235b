#include "player/host/viewer.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "player/host/panels.h"
#include "player/scene/shot_file.h"

namespace tet4d::host {
namespace {

constexpr std::size_t kHistory = 120;  // pictures whose cost is kept
constexpr std::size_t kMostMessages = 6;
constexpr double kWheelSeconds = 0.25;       // after a turn of the wheel another one is likely
constexpr double kTurnDegreesPerUnit = 0.4;  // of a drag
constexpr double kZoomPerNotch = 0.88;
constexpr double kPageSeconds = 0.005;  // between looks whether pages have come
constexpr double kScanSeconds = 0.02;   // and whether a column's range is known

ImGuiIO& guiIo() { return ImGui::GetIO(); }

void mapKeys() {
  ImGuiIO& io = guiIo();
  const std::pair<ImGuiKey_, Key> pairs[] = {
      {ImGuiKey_LeftArrow, Key::kLeft},      {ImGuiKey_RightArrow, Key::kRight}, {ImGuiKey_UpArrow, Key::kUp},
      {ImGuiKey_DownArrow, Key::kDown},      {ImGuiKey_Home, Key::kHome},        {ImGuiKey_End, Key::kEnd},
      {ImGuiKey_Escape, Key::kEscape},       {ImGuiKey_Tab, Key::kTab},          {ImGuiKey_Enter, Key::kEnter},
      {ImGuiKey_Backspace, Key::kBackspace}, {ImGuiKey_Delete, Key::kDelete}};
  for (const auto& [gui, key] : pairs) io.KeyMap[gui] = static_cast<int>(key);
}

}  // namespace

Viewer::Viewer(const ViewerOptions& options)
    : options_(options), files_(options.budget_bytes, options.threads), motion_(options.samples) {
  state_.width = options.width;
  state_.height = options.height;
  state_.scale = options.scale > 0 ? options.scale : 1;
  state_.samples = options.samples;
  state_.smooth = options.smooth;
  state_.panels = options.panels;
  if (options.shot) state_.shot = *options.shot;
  gui_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(gui_);
  guiIo().IniFilename = nullptr;  // nothing is written but what is asked for
  guiIo().LogFilename = nullptr;
  mapKeys();
  stylePanels(state_.scale);
}

Viewer::~Viewer() {
  ImGui::SetCurrentContext(gui_);
  canvas_.reset();
  renderer_.reset();
  ImGui::DestroyContext(gui_);
}

Status Viewer::start(render::GlResolver resolver, std::unique_ptr<render::Renderer> renderer) {
  ImGui::SetCurrentContext(gui_);
  auto canvas = render::GlPanels::create(resolver);
  if (!canvas.ok()) return canvas.fault();
  canvas_ = std::move(canvas).value();
  renderer_ = std::move(renderer);
  return {};
}

Status Viewer::open(const std::string& path) {
  const bool is_first = files_.count() == 0;
  if (Status status = files_.open(path, state_.shot); !status.ok()) return status;
  state_.selected = files_.all().size() - 1;
  const ViewerFile& file = *files_.all().back();
  if (file.file.header().triangles == 0) say(path + " has no triangles: nothing of it is drawn");
  filesChanged();
  if (is_first) state_.timeline.setTime(state_.timeline.first());
  return {};
}

ViewerFile* Viewer::selected() {
  const auto& files = files_.all();
  if (state_.selected >= files.size() || files[state_.selected] == nullptr) {
    const auto at = std::find_if(files.begin(), files.end(), [](const auto& file) { return file != nullptr; });
    if (at == files.end()) return nullptr;
    state_.selected = static_cast<std::size_t>(at - files.begin());
  }
  return files[state_.selected].get();
}

void Viewer::removeFile(std::size_t rank) {
  files_.remove(rank);
  filesChanged();
}

void Viewer::filesChanged() {
  box_ = files_.box();
  state_.timeline.setTable(files_.times());
  scene_changed_ = true;
  settling_ = 3;
  if (files_.count() == 0 || options_.shot || moved_by_hand_) return;
  if (!has_view_) {
    const scene::Material material = state_.shot.material;
    const scene::Background background = state_.shot.background;
    state_.shot = scene::defaultShot(box_, pictureSize().x / std::max(pictureSize().y, 1.0));
    state_.shot.material = material;
    state_.shot.background = background;
    has_view_ = true;
  }
  state_.shot.view = scene::fit(state_.shot.view, pictureSize(), freeFrame(), box_);
}

scene::Shot Viewer::shot() const {
  scene::Shot shot = state_.shot;
  for (const auto& file : files_.all()) {
    if (file == nullptr) continue;
    shot.material = file->material;
    break;
  }
  return shot;
}

scene::Frame Viewer::freeFrame() const {
  const PanelLayout layout = panelLayout(state_);
  const double left = layout.side ? layout.side_right : 0, bottom = layout.bar ? layout.bar_top : layout.height;
  return {left * state_.scale, 0, std::max(1.0, (layout.width - left) * state_.scale),
          std::max(1.0, bottom * state_.scale)};
}

void Viewer::handle(Event event) { events_.push_back(std::move(event)); }

// ---- events

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
  ImGuiIO& io = guiIo();
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
  guiIo().MousePos = {static_cast<float>(event.x), static_cast<float>(event.y)};
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
  ImGuiIO& io = guiIo();
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
  state_.shot.view = scene::fit(state_.shot.view, pictureSize(), freeFrame(), box_);
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
  const bool theirs = guiIo().WantCaptureMouse;
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

// ---- a frame

void Viewer::layOut(double seconds) {
  ImGuiIO& io = guiIo();
  const auto scale = static_cast<float>(state_.scale);
  io.DisplaySize = {static_cast<float>(state_.width) / scale, static_cast<float>(state_.height) / scale};
  io.DisplayFramebufferScale = {scale, scale};
  io.DeltaTime = std::max(1e-4f, static_cast<float>(seconds));
  ImGui::NewFrame();
  pointInPicture();
  layOutPanels(*this);
  ImGui::Render();
  draw_data_ = ImGui::GetDrawData();
}

Viewer::Outcome Viewer::frame(double seconds) {
  ImGui::SetCurrentContext(gui_);
  if (!events_.empty()) settling_ = 3;
  const std::size_t messages = state_.messages.size();
  for (Message& message : state_.messages) message.age_s += seconds;
  std::erase_if(state_.messages, [](const Message& m) { return m.age_s > messageSeconds(m); });
  if (state_.messages.size() != messages) settling_ = std::max(settling_, 1);
  wheeled_s_ += seconds;
  const std::size_t scans = files_.scansDone();
  if (std::exchange(scans_seen_, scans) != scans) settling_ = 3;
  Outcome outcome;
  if (canvas_ == nullptr) {  // not started: sizes are taken, nothing is drawn
    while (!events_.empty()) takeEvents();
    return outcome;
  }
  double passed = seconds;
  do {
    takeEvents();
    if (isMinimised()) continue;
    layOut(passed);
    passed = 0;
  } while (!events_.empty());
  if (isMinimised()) {  // nothing to see, nothing moves
    outcome.wait_s = std::numeric_limits<double>::infinity();
    return outcome;
  }
  outcome.changed = drawChanges(seconds) || settling_ > 0;
  if (settling_ > 0) --settling_;
  outcome.wait_s = waitSeconds();
  return outcome;
}

bool Viewer::isMoving() const {
  return state_.timeline.playing() || drag_ != Drag::kNone || wheeled_s_ < kWheelSeconds || ImGui::IsAnyItemActive();
}

double Viewer::waitSeconds() const {
  if (state_.quit || state_.timeline.playing() || recorder_ || settling_ > 0 || scene_changed_) return 0;
  if (files_.isScanning()) return kScanSeconds;
  if (files_.scansDone() != scans_seen_) return 0;
  if (state_.stats.pages_waiting > 0) return kPageSeconds;
  double wait = picture_is_full_ ? std::numeric_limits<double>::infinity() : 0.05;
  for (const Message& message : state_.messages) wait = std::min(wait, messageSeconds(message) - message.age_s + 0.01);
  return wait;
}

bool Viewer::drawChanges(double seconds) {
  if (recorder_) return recordPicture();
  if (state_.timeline.advance(seconds) || state_.stats.pages_waiting > 0) scene_changed_ = true;
  if (state_.stats.ranges_waiting > files_.rangesWaiting()) scene_changed_ = true;
  const bool full = !isMoving();
  if (!scene_changed_ && (picture_is_full_ || !full)) return false;
  scene_changed_ = false;
  return drawScene(full);
}

Pace Viewer::pace() const {
  const Timeline& timeline = state_.timeline;
  if (!timeline.playing()) return {};
  const double speed = timeline.unitsPerSecond();
  return {timeline.backward() ? -speed : speed, timeline.begin(), timeline.end(), timeline.loop() == Loop::kLoop};
}

void Viewer::setBudget(double ms, std::uint32_t samples) {
  state_.budget_ms = ms;
  state_.samples = samples;
  budget_ = scene::FrameBudget(ms);
  motion_ = scene::MotionQuality(samples);
  scene_changed_ = true;
}

Result<render::Image> Viewer::draw(double time, const scene::Format& format, bool whole, SceneStats& stats) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  std::vector<Fault> faults;
  const scene::DrawList list = files_.list({time, format, state_.smooth, pace(), whole}, state_.shot, stats, faults);
  stats.is_first = kinds_.isFirst(list);
  auto image = renderer_->draw(list, files_.residencies());
  if (image.ok() && state_.legend) drawLegendOn(image.value(), whole);
  stats.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  for (const Fault& fault : faults) report(fault);
  return image;
}

// Where the panels leave room; in a picture that is kept, where there are none.
void Viewer::drawLegendOn(render::Image& image, bool whole) const {
  const std::vector<Legend> legends = files_.legends();
  if (legends.empty()) return;
  const double width = image.width, height = image.height;
  const double factor = width / std::max(1u, state_.width);
  const scene::Frame room = freeFrame();
  const scene::Frame within =
      whole ? scene::Frame{0, 0, width, height}
            : scene::Frame{factor * room.left, factor * room.top, factor * room.width, factor * room.height};
  drawLegends(image, legends, within, factor * legendLine(state_.width, state_.height), isDark(state_.shot.background));
}

void Viewer::show(render::Image picture, const SceneStats& stats) {
  picture_ = std::move(picture);
  state_.stats = stats;
  state_.frame_ms.push_back(static_cast<float>(stats.ms));
  if (state_.frame_ms.size() > kHistory) state_.frame_ms.erase(state_.frame_ms.begin());
  if (Status status = canvas_->setPicture(picture_); !status.ok()) report(status.fault());
}

bool Viewer::drawScene(bool full) {
  const double pixels = static_cast<double>(state_.width) * state_.height;
  const SceneStats& last = state_.stats;
  state_.quality = motion_.next(budget_, pixels, static_cast<double>(last.processed),
                                static_cast<double>(last.bytes_touched), !full);
  const std::uint32_t divide = state_.quality.divide;
  const scene::Format format{std::max(1u, state_.width / divide), std::max(1u, state_.height / divide),
                             state_.quality.samples};
  SceneStats stats;
  auto image = draw(state_.timeline.time(), format, false, stats);
  picture_is_full_ = full;
  if (!image.ok()) {
    state_.timeline.play(false);
    report(image.fault());
    return true;
  }
  if (!stats.is_first) {
    budget_.add({static_cast<double>(stats.processed), static_cast<double>(stats.bytes_touched),
                 static_cast<double>(format.width) * format.height * format.samples},
                stats.ms);
  }
  state_.budget = budget_.report();
  show(std::move(image).value(), stats);
  return true;
}

// ---- what is saved

bool Viewer::recordPicture() {
  state_.timeline.setTime(recorder_->nextTime());
  SceneStats stats;
  auto image = draw(recorder_->nextTime(), recorder_->format(), true, stats);
  Status status = image.ok() ? recorder_->add(image.value()) : Status(image.fault());
  if (image.ok()) show(std::move(image).value(), stats);
  if (!status.ok()) {
    report(status.fault());
    recorder_.reset();
  } else if (recorder_->done()) {
    endFilm();
  }
  settling_ = std::max(settling_, 1);
  picture_is_full_ = false;
  return true;
}

void Viewer::toggleFilm() {
  if (recorder_) {
    if (Status status = recorder_->finish(); !status.ok()) {
      report(status.fault());
      recorder_.reset();
      return;
    }
    return endFilm();
  }
  if (files_.count() == 0) return say("there is nothing to film: drop a file on the window");
  state_.timeline.play(false);
  auto started = Recorder::start(options_.directory, state_.film_kind, state_.film_fps,
                                 state_.timeline.filmTimes(static_cast<unsigned>(std::max(0, state_.film_between))),
                                 {state_.width, state_.height, state_.samples});
  if (!started.ok()) return report(started.fault());
  recorder_ = std::move(started).value();
}

void Viewer::endRecording() {
  if (recorder_) toggleFilm();
}

void Viewer::endFilm() {
  say("wrote " + recorder_->name() + ", " + std::to_string(recorder_->taken()) +
      (recorder_->taken() == 1 ? " picture" : " pictures"));
  recorder_.reset();
  scene_changed_ = true;
}

void Viewer::savePictureNow() {
  if (files_.count() == 0) return say("there is nothing to save: drop a file on the window");
  SceneStats stats;
  auto image = draw(state_.timeline.time(), {state_.width, state_.height, state_.samples}, true, stats);
  if (!image.ok()) return report(image.fault());
  const auto name = savePicture(options_.directory, image.value());
  if (!name.ok()) return report(name.fault());
  say("wrote " + name.value());
}

// ---- actions

void Viewer::actOnTime(Action action) {
  Timeline& timeline = state_.timeline;
  if (recorder_) return;  // the film says what time it is
  scene_changed_ = true;
  switch (action) {
    case Action::kPlay:
      return timeline.play(!timeline.playing());
    case Action::kStepBack:
      return timeline.step(-1);
    case Action::kStepForward:
      return timeline.step(1);
    case Action::kFirst:
      return timeline.toBegin();
    case Action::kLast:
      return timeline.toEnd();
    case Action::kSlower:
      return timeline.setSpeed(timeline.speed() / 2);
    case Action::kFaster:
      return timeline.setSpeed(timeline.speed() * 2);
    case Action::kReverse:
      return timeline.setBackward(!timeline.backward());
    case Action::kLoop:
      return timeline.setLoop(timeline.loop() == Loop::kLoop       ? Loop::kPingPong
                              : timeline.loop() == Loop::kPingPong ? Loop::kOnce
                                                                   : Loop::kLoop);
    case Action::kRangeBegin:
      return timeline.setBegin(timeline.time());
    case Action::kRangeEnd:
      return timeline.setEnd(timeline.time());
    default:
      return timeline.wholeRange();
  }
}

void Viewer::look(scene::StandardView side) {
  state_.shot.view = scene::standardView(side, state_.shot.view, pictureSize(), freeFrame(), box_);
}

void Viewer::actOnView(Action action) {
  using scene::StandardView;
  if (files_.count() == 0 || state_.width == 0) return;
  scene_changed_ = true;
  moved_by_hand_ = action != Action::kFit;
  switch (action) {
    case Action::kFit:
      state_.shot.view = scene::fit(state_.shot.view, pictureSize(), freeFrame(), box_);
      return;
    case Action::kFront:
      return look(StandardView::kFront);
    case Action::kRight:
      return look(StandardView::kRight);
    case Action::kTop:
      return look(StandardView::kTop);
    case Action::kBack:
      return look(StandardView::kBack);
    case Action::kLeft:
      return look(StandardView::kLeft);
    case Action::kBottom:
      return look(StandardView::kBottom);
    case Action::kProjection:
      state_.shot.view = scene::toggleProjection(state_.shot.view, box_.centre);
      return;
    default:
      return look(StandardView::kThreeQuarter);
  }
}

// From the material by parts, if there are several, and each column to the material again.
void Viewer::colorByNext() {
  ViewerFile* file = selected();
  if (file == nullptr) return say("there is nothing to colour: drop a file on the window");
  scene::Coloring& coloring = file->coloring;
  const std::size_t columns = file->file.columns().size();
  const bool has_parts = file->file.parts().size() > 1;
  if (columns == 0 && !has_parts) return say(file->path + " has neither columns nor parts to colour by");
  if (coloring.by == scene::ColorBy::kMaterial && has_parts) {
    coloring.by = scene::ColorBy::kPart;
    return;
  }
  const std::size_t next = coloring.by == scene::ColorBy::kColumn ? coloring.column + 1 : 0;
  colorByColumn(*file, next);
}

void Viewer::actOnLook(Action action) {
  scene_changed_ = true;
  switch (action) {
    case Action::kSmooth:
      state_.smooth = !state_.smooth;
      return;
    case Action::kNextColors:
      return colorByNext();
    case Action::kLegend:
      state_.legend = !state_.legend;
      if (state_.legend && files_.legends().empty()) say("the legend explains colours by a column or by parts: c");
      return;
    case Action::kLit:
      if (ViewerFile* file = selected()) file->coloring.lit = !file->coloring.lit;
      return;
    case Action::kRoom:
      toggleRoom(state_.shot.background);
      return;
    default:
      toggleDark(state_.shot.background);
  }
}

void Viewer::act(Action action) {
  ImGui::SetCurrentContext(gui_);
  settling_ = 3;
  state_.is_new = false;
  if (action <= Action::kRangeAll) return actOnTime(action);
  if (action <= Action::kProjection) return actOnView(action);
  if (action <= Action::kDark) return actOnLook(action);
  switch (action) {
    case Action::kSavePicture:
      return savePictureNow();
    case Action::kFilm:
      return toggleFilm();
    case Action::kWriteCamera: {
      const auto name = saveText(options_.directory, "camera", ".json", scene::formatShot(shot()));
      return name.ok() ? say("wrote " + name.value()) : report(name.fault());
    }
    case Action::kPanels:
      state_.panels = !state_.panels;
      if (!moved_by_hand_ && !options_.shot) actOnView(Action::kFit);
      return;
    case Action::kHelp:
      state_.help = !state_.help;
      return;
    case Action::kClose:
      if (!state_.help && recorder_) toggleFilm();
      if (!state_.help) state_.messages.clear();
      state_.help = false;
      return;
    default:
      endRecording();
      state_.quit = true;
  }
}

// ---- messages

void Viewer::say(const std::string& text) { report({FaultCode::kUsage, "", "", text, ""}); }

void Viewer::report(const Fault& fault) {
  Message message;
  for (const std::string* part : {&fault.file, &fault.place, &fault.what}) {
    if (!part->empty()) message.text += (message.text.empty() ? "" : ": ") + *part;
  }
  message.remedy = fault.remedy;
  message.is_error = !fault.remedy.empty() || !fault.file.empty();
  settling_ = 3;
  if (!state_.messages.empty() && state_.messages.back().text == message.text) {
    ++state_.messages.back().count;
    state_.messages.back().age_s = 0;
    return;
  }
  if (state_.messages.size() == kMostMessages) state_.messages.erase(state_.messages.begin());
  state_.messages.push_back(std::move(message));
}

// ---- out

Status Viewer::present(unsigned framebuffer) {
  if (isMinimised()) return {};
  return canvas_->draw(draw_data_, framebuffer, state_.width, state_.height);
}

Result<render::Image> Viewer::readWindow() { return canvas_->read(0, state_.width, state_.height); }

Result<render::Image> Viewer::screenshot() { return canvas_->drawOffscreen(draw_data_, state_.width, state_.height); }

}  // namespace tet4d::host
