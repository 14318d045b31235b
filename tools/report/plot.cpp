#include "tools/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/report/canvas.h"
#include "tools/report/escape.h"

namespace tet4d::report {
namespace {

constexpr double kLeft = 76, kRight = 180, kTop = 36, kBottom = 56;
constexpr const char* kInk = "#333333";
constexpr const char* kGrid = "#dddddd";
// Okabe and Ito's colours, which colour-blind readers can tell apart.
constexpr std::array<const char*, 8> kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#666666", "#000000"};

struct Axis {
  double low = 0, high = 1;  // in logarithms if log
  bool log = false;

  bool shows(double value) const { return std::isfinite(value) && (!log || value > 0); }
  double place(double value) const {
    const double v = log ? std::log10(value) : value;
    return (v - low) / (high - low);
  }
};

Axis axisOf(const std::vector<double>& values, bool log) {
  Axis axis{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), log};
  for (const double value : values) {
    const double v = log ? std::log10(value) : value;
    axis.low = std::min(axis.low, v);
    axis.high = std::max(axis.high, v);
  }
  if (values.empty()) axis.low = 0, axis.high = 1;
  if (!log) axis.low = std::min(axis.low, 0.0);
  const double margin = axis.high > axis.low ? 0.06 * (axis.high - axis.low) : 0.5;
  axis.low -= log ? margin : 0;
  axis.high += margin;
  return axis;
}

std::vector<double> ticksOf(const Axis& axis) {
  std::vector<double> ticks;
  if (axis.log) {
    const double decades = axis.high - axis.low;
    const int step = std::max(1, static_cast<int>(std::ceil(decades / 8)));
    for (int e = static_cast<int>(std::floor(axis.low)); e <= axis.high; ++e) {
      for (const double m : {1.0, 2.0, 5.0}) {
        const double value = m * std::pow(10.0, e), at = std::log10(value);
        if (at < axis.low || at > axis.high || (m > 1 && decades > 2.5) || (e % step != 0)) continue;
        ticks.push_back(value);
      }
    }
    return ticks;
  }
  const double raw = (axis.high - axis.low) / 5, unit = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = raw / unit < 1.5 ? unit : raw / unit < 3.5 ? 2 * unit : raw / unit < 7.5 ? 5 * unit : 10 * unit;
  for (double k = std::ceil(axis.low / step); k * step <= axis.high; ++k) ticks.push_back(k * step);
  return ticks;
}

std::string tickText(double value) { return fmt::format("{:.3g}", value); }

struct Frame {
  Axis x, y;
  double px(double value) const { return kLeft + x.place(value) * (kPlotWidth - kLeft - kRight); }
  double py(double value) const { return kPlotHeight - kBottom - y.place(value) * (kPlotHeight - kTop - kBottom); }
};

void drawAxes(const Plot& plot, const Frame& frame, Canvas& canvas) {
  const double right = kPlotWidth - kRight, bottom = kPlotHeight - kBottom;
  for (const double tick : ticksOf(frame.x)) {
    const double x = frame.px(tick);
    canvas.line({{x, kTop}, {x, bottom}}, kGrid, 1);
    canvas.text(x, bottom + 16, tickText(tick), Anchor::kMiddle, 11, false);
  }
  for (const double tick : ticksOf(frame.y)) {
    const double y = frame.py(tick);
    canvas.line({{kLeft, y}, {right, y}}, kGrid, 1);
    canvas.text(kLeft - 6, y + 4, tickText(tick), Anchor::kEnd, 11, false);
  }
  canvas.line({{kLeft, kTop}, {kLeft, bottom}, {right, bottom}}, kInk, 1.2);
  canvas.text(kLeft, 20, plot.title, Anchor::kStart, 14, false);
  canvas.text((kLeft + right) / 2, bottom + 36, plot.x_label, Anchor::kMiddle, 12, false);
  canvas.text(18, (kTop + bottom) / 2, plot.y_label, Anchor::kMiddle, 12, true);
}

void drawSeries(const Series& series, std::size_t rank, const Frame& frame, Canvas& canvas) {
  const std::string colour = kColours[rank % kColours.size()];
  std::vector<std::pair<double, double>> line;
  for (const PlotPoint& point : series.points) {
    if (frame.x.shows(point.x) && frame.y.shows(point.y)) line.emplace_back(frame.px(point.x), frame.py(point.y));
  }
  if (line.size() > 1) canvas.line(line, colour, 1.6);
  for (const PlotPoint& point : series.points) {
    if (!frame.x.shows(point.x) || !frame.y.shows(point.y)) continue;
    canvas.dot(frame.px(point.x), frame.py(point.y), 3.4, colour);
    if (!point.label.empty())
      canvas.text(frame.px(point.x) + 6, frame.py(point.y) - 5, point.label, Anchor::kStart, 10, false);
  }
  const double y = kTop + 8 + 18 * static_cast<double>(rank), x = kPlotWidth - kRight + 12;
  canvas.line({{x, y}, {x + 18, y}}, colour, 1.6);
  canvas.dot(x + 9, y, 3.4, colour);
  canvas.text(x + 24, y + 4, series.name, Anchor::kStart, 11, false);
}

class SvgCanvas final : public Canvas {
 public:
  void line(const std::vector<std::pair<double, double>>& points, const std::string& colour, double width) override {
    std::string list;
    for (const auto& [x, y] : points) list += fmt::format("{}{:.1f},{:.1f}", list.empty() ? "" : " ", x, y);
    out_ +=
        fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n", list, colour, width);
  }
  void dot(double x, double y, double radius, const std::string& colour) override {
    out_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, radius, colour);
  }
  void text(double x, double y, const std::string& text, Anchor anchor, double size, bool upwards) override {
    const char* where = anchor == Anchor::kStart ? "start" : anchor == Anchor::kMiddle ? "middle" : "end";
    const std::string turn = upwards ? fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", x, y) : "";
    out_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\"{}>{}</text>\n",
                        x, y, size, where, kInk, turn, escaped(text));
  }
  std::string document() const {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n{2}</svg>\n",
        kPlotWidth, kPlotHeight, out_);
  }

 private:
  std::string out_;
};

}  // namespace

void draw(const Plot& plot, Canvas& canvas) {
  std::vector<double> xs, ys;
  std::size_t hidden = 0;
  const Axis x{0, 1, plot.log_x}, y{0, 1, plot.log_y};
  for (const Series& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      if (x.shows(point.x) && y.shows(point.y)) {
        xs.push_back(point.x);
        ys.push_back(point.y);
      } else {
        ++hidden;
      }
    }
  }
  const Frame frame{axisOf(xs, plot.log_x), axisOf(ys, plot.log_y)};
  drawAxes(plot, frame, canvas);
  for (std::size_t i = 0; i < plot.series.size(); ++i) drawSeries(plot.series[i], i, frame, canvas);
  if (hidden > 0) {
    canvas.text(kPlotWidth - 8, kPlotHeight - 6, fmt::format("{} of 0, or without a number, not shown", hidden),
                Anchor::kEnd, 10, false);
  }
}

std::string svgOf(const Plot& plot) {
  SvgCanvas canvas;
  draw(plot, canvas);
  return canvas.document();
}

}  // namespace tet4d::report
