#include "tools/report/plot.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include "tools/report/axis.h"
#include "tools/report/canvas.h"

namespace tet4d::report {
namespace {

// Ticks in the axis, in order, that a reader can tell apart and take at their word.
void expectTicks(const Axis& axis) {
  const std::vector<Tick> ticks = ticksOf(axis);
  EXPECT_GE(ticks.size(), 2U) << "from " << axis.low << " to " << axis.high;
  EXPECT_LE(ticks.size(), 12U) << "from " << axis.low << " to " << axis.high;
  std::set<std::string> texts;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    EXPECT_TRUE(axis.place(ticks[i].value) > -1e-9 && axis.place(ticks[i].value) < 1 + 1e-9) << ticks[i].text;
    EXPECT_TRUE(texts.insert(ticks[i].text).second) << ticks[i].text << " twice";
    EXPECT_NEAR(axis.place(std::stod(ticks[i].text)), axis.place(ticks[i].value), 0.01);
    if (i > 0) {
      EXPECT_LT(ticks[i - 1].value, ticks[i].value);
    }
  }
}

std::vector<std::string> textsOf(const std::vector<double>& values, bool log) {
  std::vector<std::string> texts;
  for (const Tick& tick : ticksOf(axisOf(values, log))) texts.push_back(tick.text);
  return texts;
}

TEST(Axis, EveryRangeHasTwoTicks) {
  for (const double from : {1e-300, 3.1e-9, 0.0021, 0.97, 1.0, 2.1, 4.9, 6.3, 12345.0, 7e12}) {
    for (const double factor : {1.0, 1 + 1e-15, 1 + 1e-6, 1.0004, 1.01, 1.1,   1.5, 1.9, 2.0,  2.3,
                                3.0, 4.2,       9.0,      11.0,   99.0, 320.0, 1e4, 1e9, 1e40, 1e280}) {
      for (const bool log : {true, false}) expectTicks(axisOf({from, factor * from}, log));
      expectTicks(axisOf({-factor * from, -from}, false));
    }
  }
  for (const bool log : {true, false}) expectTicks(axisOf({}, log));
  expectTicks(axisOf({0}, false));
}

TEST(Axis, FallsBackFromDecadesToPartsToLinearSteps) {
  EXPECT_EQ(textsOf({0.01, 100}, true), (std::vector<std::string>{"0.01", "0.1", "1", "10", "100"}));
  EXPECT_EQ(textsOf({1.8, 22}, true), (std::vector<std::string>{"2", "5", "10", "20"}));
  EXPECT_EQ(textsOf({6, 9}, true), (std::vector<std::string>{"6", "6.5", "7", "7.5", "8", "8.5", "9"}));
  EXPECT_EQ(textsOf({2.2, 4.8}, true),  // above a factor of two, but between 2 and 5
            (std::vector<std::string>{"2.5", "3", "3.5", "4", "4.5", "5"}));
}

struct Text {
  double left, top, right, bottom;
  std::string text;
};

class Recorder final : public Canvas {
 public:
  void line(const std::vector<std::pair<double, double>>& points, const std::string&, double width) override {
    if (points.size() == 3 && width == 1.2) axes = points;
    lines.push_back(points);
  }
  void dot(double, double, double, const std::string&) override {}
  void text(double x, double y, const std::string& text, Anchor anchor, double size, bool upwards) override {
    if (upwards) return;
    const double width = 0.6 * size * static_cast<double>(text.size());
    const double left = anchor == Anchor::kStart ? x : anchor == Anchor::kEnd ? x - width : x - width / 2;
    texts.push_back({left, y - size, left + width, y, text});
  }
  const Text& find(const std::string& text) const {
    const auto found = std::find_if(texts.begin(), texts.end(), [&](const Text& t) { return t.text == text; });
    if (found == texts.end()) throw std::runtime_error("no text " + text);
    return *found;
  }
  std::vector<std::pair<double, double>> axes;  // top left, bottom left, bottom right
  std::vector<std::vector<std::pair<double, double>>> lines;
  std::vector<Text> texts;
};

Plot plotOf(const std::vector<PlotPoint>& points) {
  return {"name", "title", "x", "y", true, true, {{"renderer cpu, a file of long name", points}}};
}

void expectInside(const Recorder& canvas, const std::string& label) {
  const Text& text = canvas.find(label);
  EXPECT_GE(text.left, canvas.axes[0].first) << label;
  EXPECT_LE(text.right, canvas.axes[2].first) << label;
  EXPECT_GE(text.top, canvas.axes[0].second) << label;
  EXPECT_LE(text.bottom, canvas.axes[1].second) << label;
}

TEST(Plot, LabelsStayInTheBoxOfTheAxes) {
  const std::vector<PlotPoint> corners{{1, 1, "low left, a label"},
                                       {1, 9, "high left, a label"},
                                       {900, 1, "low right, a label"},
                                       {900, 9, "high right, a label"},
                                       {30, 3, "middle"}};
  for (const auto& points : {corners, std::vector<PlotPoint>{{2, 3, "single, a label of some length"}},
                             std::vector<PlotPoint>{{2, 3, "one of two"}, {2.001, 3.001, "two of two"}}}) {
    Recorder canvas;
    draw(plotOf(points), canvas);
    ASSERT_EQ(canvas.axes.size(), 3U);
    for (const PlotPoint& point : points) expectInside(canvas, point.label);
    const Text& name = canvas.find("renderer cpu, a file of long name");
    EXPECT_GT(name.left, canvas.axes[2].first) << "the legend is not beside the axes";
    EXPECT_LE(name.right, kPlotWidth);
  }
}

TEST(Plot, LabelsStandOnFreeGroundAndAreShortenedWhereTheyCannotFit) {
  Recorder canvas;
  draw(plotOf({{10, 10, "a label"}, {10, 10, "another"}, {100, 100, std::string(500, 'm')}}), canvas);
  const Text &a = canvas.find("a label"), &b = canvas.find("another");
  EXPECT_TRUE(a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top);
  const auto cut =
      std::find_if(canvas.texts.begin(), canvas.texts.end(), [](const Text& t) { return t.text[0] == 'm'; });
  ASSERT_NE(cut, canvas.texts.end());
  EXPECT_LT(cut->text.size(), 100U);
  EXPECT_EQ(cut->text.substr(cut->text.size() - 3), "\u2026");
  EXPECT_GE(cut->left, canvas.axes[0].first);
}

TEST(Plot, CurvesDoNotGoBackwards) {
  Recorder canvas;
  draw(plotOf({{9, 1, ""}, {8, 2, ""}, {10, 3, ""}, {1, 4, ""}}), canvas);
  std::size_t curves = 0;
  for (const auto& line : canvas.lines) {
    if (line.size() != 4) continue;
    ++curves;
    EXPECT_TRUE(std::is_sorted(line.begin(), line.end()));
  }
  EXPECT_EQ(curves, 1U);
}

TEST(Plot, BothFormatsAreWritten) {
  const Plot plot = plotOf({{5, 7, "5 < 7"}});
  EXPECT_NE(svgOf(plot).find("5 &lt; 7"), std::string::npos);
  EXPECT_EQ(svgOf(plot), svgOf(plot));
  if (!hasPng()) GTEST_SKIP() << "without cairo";
  const std::string path = testing::TempDir() + "/tet4d-plot-test-" + std::to_string(::getpid()) + ".png";
  writePng(plot, path);
  EXPECT_GT(std::filesystem::file_size(path), 1000U);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tet4d::report
