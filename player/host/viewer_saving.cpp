// What a viewer writes: pictures, films, camera files.
#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "player/host/viewer.h"
#include "player/scene/shot_file.h"

namespace tet4d::host {
namespace {

// Who has not read where pictures go finds them by this.
std::string withFolder(const std::string& name) {
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::absolute(name, error);
  return error ? name : whole.filename().string() + " in " + whole.parent_path().lexically_normal().string();
}

}  // namespace

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

// What is seen at x 1 are kFramesPerSecond frames a second.
double Viewer::filmFps() const {
  const double played = Timeline::kFramesPerSecond * state_.timeline.speed() * (std::max(0, state_.film_between) + 1);
  return std::clamp(state_.film_fps.value_or(played), kLeastFps, kMostFps);
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
  auto started = Recorder::start(options_.directory, state_.film_kind, filmFps(),
                                 state_.timeline.filmTimes(static_cast<unsigned>(std::max(0, state_.film_between))),
                                 {state_.width, state_.height, state_.samples});
  if (!started.ok()) return report(started.fault());
  recorder_ = std::move(started).value();
}

void Viewer::endRecording() {
  if (recorder_) toggleFilm();
}

void Viewer::endFilm() {
  say("wrote " + std::to_string(recorder_->taken()) + (recorder_->taken() == 1 ? " picture: " : " pictures: ") +
      withFolder(recorder_->name()));
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
  say("wrote " + withFolder(name.value()));
}

void Viewer::writeCamera() {
  const auto name = saveText(options_.directory, "camera", ".json", scene::formatShot(shot()));
  return name.ok() ? say("wrote " + withFolder(name.value())) : report(name.fault());
}

}  // namespace tet4d::host
