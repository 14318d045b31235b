// Draws test files and looks at the pictures.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "player/render/renderer.h"
#include "player/scene/dyntri_chooser.h"
#include "player/stream/page_source.h"

namespace tet4d::test {

// An open file with what is needed to draw it.
class Stage {
 public:
  explicit Stage(const std::string& path) {
    auto file = dyntri::File::open(path);
    if (!file.ok()) throw std::runtime_error(file.fault().what);
    file_.emplace(std::move(file).value());
    source_.emplace(*file_, std::uint64_t{1} << 30);
    box = scene::worldBox(file_->header().index_to_world, file_->header().bounds);
    shot = scene::defaultShot(box, 1.5);
  }

  scene::DrawList list(float t) {
    scene::DrawList list = scene::makeDrawList(box, shot, format, smooth);
    const float last_t = file_->header().last_time;
    const auto pages = scene::choosePages(file_->geometryEntries(), t, last_t, list, list.surfaces[0]);
    source_->beginFrame();
    for (const std::size_t page : pages) EXPECT_TRUE(source_->load(page).ok());
    scene::chooseTriangles(*source_, pages, t, last_t, list.surfaces[0]);
    return list;
  }
  render::Image draw(render::Renderer& renderer, float t) {
    auto image = renderer.draw(list(t), sources());
    EXPECT_TRUE(image.ok()) << (image.ok() ? "" : image.fault().place + ": " + image.fault().what);
    return image.ok() ? std::move(image).value() : render::Image(1, 1);
  }
  const stream::PageSource& source() const { return *source_; }
  std::array<const stream::Residency*, 1> sources() const { return {&*source_}; }
  const dyntri::File& file() const { return *file_; }

  scene::WorldBox box;
  scene::Shot shot;
  scene::Format format{300, 200, 1};
  bool smooth = true;

 private:
  std::optional<dyntri::File> file_;
  std::optional<stream::PageSource> source_;
};

// Unlit, unmistakable: outside green, inside red, behind black.
inline void paintSides(scene::Shot& shot) {
  shot.ambient = {1, 1, 1};
  shot.lights.clear();
  shot.material.color = {0, 1, 0};
  shot.material.back_color = {1, 0, 0};
  shot.background = {{0, 0, 0}, {0, 0, 0}, std::nullopt};
}

struct Sides {
  std::uint64_t front = 0, back = 0, behind = 0;
};
inline Sides countSides(const render::Image& image) {
  Sides sides;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const bool red = image.rgba[i] > 127, green = image.rgba[i + 1] > 127;
    ++(green ? sides.front : red ? sides.back : sides.behind);
  }
  return sides;
}

struct Difference {
  double rms = 0;            // of the channels, in 1/255
  double share_above_8 = 0;  // of the pixels with a channel that differs by more than 8/255
  int largest = 0;           // of a channel
};
inline Difference compare(const render::Image& a, const render::Image& b) {
  Difference d;
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  if (a.rgba.size() != b.rgba.size()) return d;
  double squares = 0;
  std::uint64_t above = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    int worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int difference = std::abs(int{a.rgba[i + c]} - int{b.rgba[i + c]});
      squares += difference * difference;
      worst = std::max(worst, difference);
    }
    d.largest = std::max(d.largest, worst);
    above += worst > 8 ? 1 : 0;
  }
  const double pixels = static_cast<double>(a.rgba.size()) / 4;
  d.rms = std::sqrt(squares / (3 * pixels));
  d.share_above_8 = static_cast<double>(above) / pixels;
  return d;
}

}  // namespace tet4d::test
