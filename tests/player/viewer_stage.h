// A viewer off-screen, driven as a user would: events in, pictures out.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "player/host/offscreen_gl.h"
#include "player/host/viewer.h"
#include "tests/player/swept_mesh.h"

namespace tet4d::test {

class ViewerStage {
 public:
  explicit ViewerStage(host::ViewerOptions options = {}) {
    auto context = host::makeOffscreenContext();
    if (!context.ok()) throw std::runtime_error(context.fault().what);
    context_ = std::move(context).value();
    directory = temporaryDirectory() + "/saved-" + std::to_string(count()++);
    std::filesystem::create_directories(directory);
    options.directory = directory;
    viewer_ = std::make_unique<host::Viewer>(options);
    auto renderer = render::makeGlRenderer(context_->resolver(), std::uint64_t{1} << 28);
    if (!renderer.ok()) throw std::runtime_error(renderer.fault().what);
    EXPECT_TRUE(viewer_->start(context_->resolver(), std::move(renderer).value()).ok());
  }
  host::Viewer& operator*() { return *viewer_; }
  host::Viewer* operator->() { return viewer_.get(); }

  void open(const std::string& path) {
    const Status status = viewer_->open(path);
    ASSERT_TRUE(status.ok()) << (status.ok() ? "" : status.fault().what);
    rest();
  }
  // Frames until nothing moves any more; at most `most`.
  int rest(int most = 20) {
    int frames = 0;
    while (frames < most && viewer_->frame(0.05).wait_s < 0.2) {
      const bool waits = viewer_->state().stats.pages_waiting > 0 || viewer_->files().isScanning();
      if (waits) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      frames += waits ? 0 : 1;
    }
    return frames;
  }
  void moveTo(double x, double y) { viewer_->handle(host::PointerMoved{x, y}); }
  void press(bool down, int button = 0, bool shift = false) {
    viewer_->handle(host::PointerButton{button, down, shift});
  }
  void click(double x, double y) {
    moveTo(x, y);
    viewer_->frame(0.01);
    press(true);
    press(false);
    rest();
  }
  void click(const std::string& place) {
    ASSERT_TRUE(viewer_->state().places.contains(place)) << place;
    const auto centre = viewer_->state().places.at(place).centre();
    click(centre.x, centre.y);
  }
  void drag(double x0, double y0, double x1, double y1, int button = 0) {
    moveTo(x0, y0);
    viewer_->frame(0.01);
    press(true, button);
    viewer_->frame(0.01);
    moveTo(x1, y1);
    viewer_->frame(0.01);
    press(false, button);
    rest();
  }
  void type(char32_t character) {
    viewer_->handle(host::Typed{character});
    rest();
  }
  void key(host::Key which) {
    viewer_->handle(host::KeyChanged{which, true, false, false});
    viewer_->frame(0.01);
    viewer_->handle(host::KeyChanged{which, false, false, false});
    rest();
  }
  render::Image screenshot() {
    auto image = viewer_->screenshot();
    EXPECT_TRUE(image.ok());
    return image.ok() ? std::move(image).value() : render::Image(1, 1);
  }
  // Names in the directory of what is saved, sorted.
  std::vector<std::string> saved() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  std::string directory;

 private:
  static int& count() {
    static int number = 0;
    return number;
  }
  std::unique_ptr<host::GlContext> context_;  // first: destroyed last
  std::unique_ptr<host::Viewer> viewer_;
};

}  // namespace tet4d::test
