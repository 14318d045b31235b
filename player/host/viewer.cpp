#include "player/host/viewer.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "player/host/panels.h"

namespace tet4d::host {
namespace {

constexpr std::size_t kHistory = 120;  // pictures whose cost is kept
constexpr std::size_t kMostMessages = 6;
constexpr double kWheelSeconds = 0.25;  // after a turn of the wheel another one is likely
constexpr double kPageSeconds = 0.005;  // between looks whether pages have come
constexpr double kScanSeconds = 0.02;   // and whether a column's range is known

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
  ImGui::GetIO().IniFilename = nullptr;  // nothing is written but what is asked for
  ImGui::GetIO().LogFilename = nullptr;
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

std::string Viewer::title() {
  const ViewerFile* file = selected();
  if (file == nullptr) return "tet4d";
  const std::size_t others = files_.count() - 1;
  return "tet4d - " + file->path + (others > 0 ? " and " + std::to_string(others) + " more" : "");
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
  state_.shot.view = scene::fit(state_.shot.view, pictureSize(), fitFrame(), box_);
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

scene::Frame Viewer::fitFrame() const {
  scene::Frame frame = freeFrame();
  frame.width -= legendRoom();
  return frame;
}

// Also of a legend that is switched off: nothing moves when it comes back. None where it would take half the picture.
double Viewer::legendRoom() const {
  if (isMinimised()) return 0;
  const scene::Frame frame = freeFrame();
  const double room = legendsWidth(files_.legends(), frame, legendLine(state_.width, state_.height));
  return room < frame.width / 2 ? room : 0;
}

// A view that nobody has moved yet gives way to a legend that comes.
void Viewer::makeRoomForLegends() {
  const double room = legendRoom();
  if (std::exchange(legend_room_, room) == room || moved_by_hand_ || options_.shot || files_.count() == 0) return;
  state_.shot.view = scene::fit(state_.shot.view, pictureSize(), fitFrame(), box_);
}

// ---- a frame

void Viewer::layOut(double seconds) {
  ImGuiIO& io = ImGui::GetIO();
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
  makeRoomForLegends();
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
