// Legends: their numbers, their letters, and what stands in the picture.
#include "player/host/legend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "player/scene/column_spread.h"
#include "tests/player/picture.h"
#include "tests/player/swept_mesh.h"

namespace tet4d::host {
namespace {

render::Image plain(std::uint32_t width, std::uint32_t height, std::uint8_t grey = 200) {
  render::Image image(width, height);
  std::fill(image.rgba.begin(), image.rgba.end(), grey);
  return image;
}

std::vector<std::string> labels(double low, double high, bool logarithmic = false, std::size_t most = 6) {
  std::vector<std::string> all;
  for (const Tick& tick : ticksOf(low, high, logarithmic, most)) all.push_back(tick.label);
  return all;
}

Legend barOf(const char* map, double low, double high) {
  Legend legend;
  legend.title = "speed [m/s]";
  for (const glm::vec3& c : scene::makeDrawColumn(0, 1, 0, 0, 1, *findColorMap(map)).table)
    legend.bar.push_back({render::toSrgb8(c.x), render::toSrgb8(c.y), render::toSrgb8(c.z)});
  legend.low = low, legend.high = high;
  return legend;
}

TEST(Ticks, AreRoundNumbers) {
  using Labels = std::vector<std::string>;
  EXPECT_EQ(labels(0, 1), (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(labels(-1, 1, false, 4), (Labels{"-1.0", "-0.5", "0.0", "0.5", "1.0"}));
  EXPECT_EQ(labels(3, 987), (Labels{"200", "400", "600", "800"}));
  EXPECT_EQ(labels(1.5e-7, 4.2e-7, false, 4), (Labels{"2e-7", "3e-7", "4e-7"}));
  EXPECT_EQ(labels(1, 1e6, true), (Labels{"1", "10", "100", "1000", "10000", "100000", "1e6"}));
  EXPECT_EQ(labels(0.9, 21, true), (Labels{"1", "2", "5", "10", "20"}));
  EXPECT_EQ(labels(7, 7), (Labels{"7.00"})) << "one value is one tick";
  EXPECT_EQ(labels(0, 0).size(), 1u);
}

// Any range: two ticks or more, in order, at their own places, as many as asked for or hardly more.
TEST(TicksStiff, OfAnyRangeStandInOrderWhereTheyBelong) {
  const double largest = double{std::numeric_limits<float>::max()};
  for (const auto& [low, high] : {std::pair{-largest, largest},
                                  {1e-38, 2e-38},
                                  {16777216.0, 16777217.0},
                                  {-5.0, -4.999},
                                  {0.0, 3e-5},
                                  {1e9, 1e12},
                                  {-0.3, 1e7},
                                  {0.0999, 0.1001}}) {
    for (const bool logarithmic : {false, true}) {
      const auto ticks = ticksOf(low, high, logarithmic, 5);
      ASSERT_GE(ticks.size(), 2u) << low << ' ' << high;
      EXPECT_LE(ticks.size(), 7u) << low << ' ' << high;
      std::set<std::string> seen;
      for (std::size_t i = 0; i < ticks.size(); ++i) {
        EXPECT_TRUE(seen.insert(ticks[i].label).second) << "twice " << ticks[i].label << " of " << low << ".." << high;
        EXPECT_TRUE(i == 0 || ticks[i].place > ticks[i - 1].place);
        const double value = std::stod(ticks[i].label);
        const bool is_log = logarithmic && low > 0;
        const double place = is_log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
        EXPECT_NEAR(place, ticks[i].place, 0.06) << ticks[i].label << " of " << low << ".." << high;
      }
    }
  }
}

TEST(StrokeFont, EveryLetterIsDrawnAndNoTwoAreAlike) {
  std::map<std::string, char> seen;
  for (char c = '!'; c <= '~'; ++c) {
    render::Image image = plain(60, 80, 255);
    drawText(image, 12, 55, 60, std::string(1, c), {0, 0, 0});
    const auto inked = std::count(image.rgba.begin(), image.rgba.end(), 0);
    EXPECT_GT(inked, 10) << c;
    // ' and | are strokes of their own lengths, l and I alike in many alphabets.
    const auto [at, is_new] = seen.emplace(std::string(image.rgba.begin(), image.rgba.end()), c);
    EXPECT_TRUE(is_new || (c == 'l' && at->second == 'I')) << c << " looks like " << at->second;
    EXPECT_GE(textWidth(std::string(1, c), 60), 0);
  }
  EXPECT_GT(textWidth("mm", 10), 2 * textWidth("m", 10));
  EXPECT_DOUBLE_EQ(textWidth("\xc3\xa9", 20), textWidth("\xe2\x82\xac", 20)) << "what is not ASCII is one box";
}

TEST(StrokeFontStiff, OutsideThePictureIsCutOff) {
  render::Image image = plain(20, 10);
  for (const double x : {-1e6, -30.0, 15.0, 1e6}) {
    for (const double y : {-1e6, -3.0, 12.0, 1e6}) drawText(image, x, y, 40, "Wg|", {0, 0, 0});
  }
  fillRectangle(image, -1e9, -1e9, 1e9, 1e9, {1, 2, 3}, 1);
  EXPECT_EQ(image.row(9)[4 * 19 + 2], 3);
  EXPECT_EQ(image.row(0)[3], 200) << "alpha is left alone";
}

TEST(Legend, TheBarRunsThroughTheMapWithTheHighestValueOnTop) {
  render::Image image = plain(640, 480);
  const Legend legend = barOf("viridis", 0, 10);
  drawLegends(image, std::span(&legend, 1), {0, 0, 640, 480}, 16, false);
  // A column of pixels that holds the last colour holds all of them in order.
  const auto colorAt = [&](std::uint32_t x, std::uint32_t y) {
    return Rgb{image.row(y)[4 * x], image.row(y)[4 * x + 1], image.row(y)[4 * x + 2]};
  };
  std::uint32_t bar = 0, top = 0, bottom = 0;
  for (std::uint32_t x = 400; x < 640 && bar == 0; ++x) {
    for (std::uint32_t y = 0; y < 480; ++y)
      bar = colorAt(x, y) == legend.bar[254] || colorAt(x, y) == legend.bar.back() ? x + 3 : bar;
  }
  ASSERT_GT(bar, 400u) << "at the right";
  for (std::uint32_t y = 1; y < 480; ++y) {
    const bool is_yellow = colorAt(bar, y)[0] > 240 && colorAt(bar, y)[2] < 60;
    const bool is_violet = colorAt(bar, y)[0] > 60 && colorAt(bar, y)[0] < 75 && colorAt(bar, y)[1] < 10;
    if (is_yellow && top == 0) top = y;
    if (is_violet) bottom = y;
  }
  EXPECT_NEAR(static_cast<double>(bottom) - static_cast<double>(top), 10 * 16, 10) << "ten lines high, yellow on top";
  const Rgb middle = colorAt(bar, (top + bottom) / 2);
  EXPECT_NEAR(middle[1], 145, 8);
  EXPECT_NEAR(middle[0], 33, 8);
  // Left of it nothing is touched.
  EXPECT_EQ(colorAt(100, 240), (Rgb{200, 200, 200}));
}

TEST(Legend, IsLeftOutWhereThereIsNoRoom) {
  const std::vector<Legend> legends(3, barOf("magma", 0, 1));
  for (const auto& [width, height] : {std::pair{1u, 1u}, {20u, 600u}, {600u, 20u}}) {
    render::Image image = plain(width, height);
    const render::Image before = image;
    drawLegends(image, legends, {0, 0, double{1} * width, double{1} * height}, legendLine(width, height), true);
    EXPECT_EQ(image.rgba, before.rgba) << width;
  }
  render::Image one = plain(150, 400), three = plain(900, 400);
  const render::Image empty = three;
  drawLegends(one, legends, {0, 0, 150, 400}, 11, true);
  drawLegends(three, legends, {0, 0, 900, 400}, 11, true);
  EXPECT_GT(test::compare(three, empty).share_above_8, 0.06);
  EXPECT_GT(test::compare(one, plain(150, 400)).share_above_8, 0.1) << "one of three fits";
}

TEST(Legend, PartsAreListedWithTheirNames) {
  const auto file = dyntri::File::open(test::writeParts("legend_parts.t4d"));
  ASSERT_TRUE(file.ok());
  scene::Coloring coloring;
  coloring.by = scene::ColorBy::kPart;
  const auto drawn = scene::drawColumnOf(coloring, file.value(), nullptr);
  ASSERT_TRUE(drawn);
  const auto legends = legendOf(file.value(), coloring, &*drawn, "");
  ASSERT_EQ(legends.size(), 1u);
  ASSERT_EQ(legends[0].entries.size(), 3u);
  EXPECT_EQ(legends[0].entries[0].label, "isovalue 0.1");
  EXPECT_EQ(legends[0].entries[1].label, "isovalue 0.5");
  EXPECT_EQ(legends[0].entries[2].label, "part 2");
  EXPECT_NE(legends[0].entries[0].color, legends[0].entries[1].color);
}

TEST(Legend, OfAColumnHasItsNameAndRange) {
  const auto file = dyntri::File::open(test::writeColumnSphere("legend_column.t4d", 3));
  ASSERT_TRUE(file.ok());
  scene::Coloring coloring;
  coloring.by = scene::ColorBy::kColumn;
  coloring.range = scene::RangeOf::kGiven;
  coloring.low = 2, coloring.high = 5;
  auto drawn = scene::drawColumnOf(coloring, file.value(), nullptr);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(legendOf(file.value(), coloring, &*drawn, "")[0].title, "speed [m/s]");
  EXPECT_EQ(legendOf(file.value(), coloring, &*drawn, "")[0].high, 5);
  coloring.column = 1, coloring.component = scene::kMagnitude;
  EXPECT_EQ(legendOf(file.value(), coloring, &*drawn, "")[0].title, "velocity: length");
  coloring.component = 1;
  EXPECT_EQ(legendOf(file.value(), coloring, &*drawn, "")[0].title, "velocity: y");
  EXPECT_TRUE(legendOf(file.value(), coloring, nullptr, "").empty()) << "material colours need none";
}

TEST(ColumnSpread, IsThatOfTheFilesValues) {
  const auto opened = dyntri::File::open(test::writeColumnSphere("spread.t4d", 3));
  ASSERT_TRUE(opened.ok());
  const dyntri::File& file = opened.value();
  std::vector<float> values;
  std::uint64_t unknown = 0;
  for (std::size_t page = 0; page < file.geometryPages(); ++page) {
    const auto bytes = file.loadGeometry(page);
    ASSERT_TRUE(bytes.ok());
    const auto view = dyntri::validatePage(bytes.value().bytes(), file.geometryEntry(page), "", page);
    ASSERT_TRUE(view.ok());
    for (const Vec4f& v : view.value().vertices) {
      if (v.t == 0) ++unknown;
      if (v.t != 0) values.push_back(100 * v.x + 10 * v.t);
    }
  }
  std::sort(values.begin(), values.end());
  std::size_t pages = 0;
  const auto spread = scene::spreadOf(file, 0, 0, [&](std::size_t done, std::size_t) {
    pages = done;
    return true;
  });
  ASSERT_TRUE(spread.ok());
  EXPECT_EQ(pages, file.geometryPages());
  EXPECT_EQ(spread.value().values, values.size());
  EXPECT_EQ(spread.value().unknown, unknown);
  EXPECT_EQ(spread.value().least, values.front());
  EXPECT_EQ(spread.value().most, values.back());
  EXPECT_EQ(spread.value().low, values[static_cast<std::size_t>(0.01 * static_cast<double>(values.size() - 1))]);
  EXPECT_EQ(spread.value().high, values[static_cast<std::size_t>(0.99 * static_cast<double>(values.size() - 1))]);
  // The length of (t, t/2, 0): zero at first, above it later.
  const auto length = scene::spreadOf(file, 1, scene::kMagnitude, [](std::size_t, std::size_t) { return true; });
  ASSERT_TRUE(length.ok());
  EXPECT_EQ(length.value().least, 0);
  EXPECT_NEAR(double{length.value().most}, 2 * std::sqrt(1.25), 1e-5);
  EXPECT_NEAR(double{length.value().least_above_zero}, std::sqrt(1.25), 1e-5);
  scene::Coloring coloring;
  coloring.range = scene::RangeOf::kAll;
  coloring.logarithmic = true;
  EXPECT_EQ(scene::rangeOf(coloring, &length.value()).low, length.value().least_above_zero) << "factors begin above 0";
  EXPECT_FALSE(scene::spreadOf(file, 0, 0, [](std::size_t, std::size_t) { return false; }).ok()) << "it can be stopped";
}

}  // namespace
}  // namespace tet4d::host
