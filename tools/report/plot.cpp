#include "tools/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "tools/report/axis.h"
#include "tools/report/canvas.h"
#include "tools/report/escape.h"

namespace tet4d::report {
namespace {

constexpr double kTop = 36, kBottom = 56, kTickSize = 11;
constexpr double kToLegend = 12, kToName = 24;  // from the axes' box to a line of the legend, from there to its name
constexpr const char* kInk = "#333333";
constexpr const char* kGrid = "#dddddd";
// Okabe and Ito's colours, which colour-blind readers can tell apart.
constexpr std::array<const char*, 8> kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#666666", "#000000"};

struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool holds(const Box& other) const {
    return other.left >= left && other.right <= right && other.top >= top && other.bottom <= bottom;
  }
  bool meets(const Box& other) const {
    return other.left < right && other.right > left && other.top < bottom && other.bottom > top;
  }
};

// Not less than a text takes in the fonts that viewers have; bytes that continue a character take nothing.
double widthOf(const std::string& text, double size) {
  const auto characters =
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  return 0.65 * size * static_cast<double>(characters);
}

// The beginning of a text that is wider than `width`.
std::string shortened(std::string text, double size, double width) {
  if (widthOf(text, size) <= width) return text;
  while (!text.empty() && widthOf(text + "\u2026", size) > width) {
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U) text.pop_back();
    if (!text.empty()) text.pop_back();
  }
  return text + "\u2026";
}

// The axes and the box between them; names of series stand right of it.
struct Frame {
  Axis x, y;
  Box box;
  double px(double value) const { return box.left + x.place(value) * (box.right - box.left); }
  double py(double value) const { return box.bottom - y.place(value) * (box.bottom - box.top); }
};

void drawAxes(const Plot& plot, const Frame& frame, Canvas& canvas) {
  const Box& box = frame.box;
  for (const Tick& tick : ticksOf(frame.x)) {
    const double x = frame.px(tick.value);
    canvas.line({{x, box.top}, {x, box.bottom}}, kGrid, 1);
    canvas.text(x, box.bottom + 16, tick.text, Anchor::kMiddle, kTickSize, false);
  }
  for (const Tick& tick : ticksOf(frame.y)) {
    const double y = frame.py(tick.value);
    canvas.line({{box.left, y}, {box.right, y}}, kGrid, 1);
    canvas.text(box.left - 6, y + 4, tick.text, Anchor::kEnd, kTickSize, false);
  }
  canvas.line({{box.left, box.top}, {box.left, box.bottom}, {box.right, box.bottom}}, kInk, 1.2);
  canvas.text(box.left, 20, plot.title, Anchor::kStart, 14, false);
  canvas.text((box.left + box.right) / 2, box.bottom + 36, plot.x_label, Anchor::kMiddle, 12, false);
  canvas.text(18, (box.top + box.bottom) / 2, plot.y_label, Anchor::kMiddle, 12, true);
}

// Labels of points, inside the axes' box: beside their point where no other label stands, on the side that has room.
class Labels {
 public:
  Labels(const Box& box, Canvas& canvas) : box_(box), canvas_(&canvas) {}

  void add(double x, double y, const std::string& label) {
    const std::string text = shortened(label, kSize, box_.right - box_.left);
    const double width = widthOf(text, kSize);
    std::optional<Box> chosen;
    for (const Box& place :
         {Box{x + 6, y - 5 - kSize, x + 6 + width, y - 5}, Box{x - 6 - width, y - 5 - kSize, x - 6, y - 5},
          Box{x + 6, y + 5, x + 6 + width, y + 5 + kSize}, Box{x - 6 - width, y + 5, x - 6, y + 5 + kSize}}) {
      if (!box_.holds(place)) continue;
      const bool free =
          std::none_of(placed_.begin(), placed_.end(), [&](const Box& other) { return other.meets(place); });
      if (!chosen || free) chosen = place;
      if (free) break;
    }
    if (!chosen) {  // too wide for either side
      const double left = std::clamp(x - width / 2, box_.left, box_.right - width);
      const double top = std::clamp(y - 5 - kSize, box_.top, box_.bottom - kSize);
      chosen = Box{left, top, left + width, top + kSize};
    }
    placed_.push_back(*chosen);
    const bool before = chosen->right <= x;  // ends at its point, however wide the viewer's font is
    canvas_->text(before ? chosen->right : chosen->left, chosen->bottom, text, before ? Anchor::kEnd : Anchor::kStart,
                  kSize, false);
  }

 private:
  static constexpr double kSize = 10;
  Box box_;
  Canvas* canvas_;
  std::vector<Box> placed_;
};

void drawSeries(const Series& series, std::size_t rank, const Frame& frame, Labels& labels, Canvas& canvas) {
  const std::string colour = kColours[rank % kColours.size()];
  std::vector<PlotPoint> points;
  std::copy_if(series.points.begin(), series.points.end(), std::back_inserter(points),
               [&](const PlotPoint& point) { return frame.x.shows(point.x) && frame.y.shows(point.y); });
  std::stable_sort(points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  std::vector<std::pair<double, double>> line;
  for (const PlotPoint& point : points) line.emplace_back(frame.px(point.x), frame.py(point.y));
  if (line.size() > 1) canvas.line(line, colour, 1.6);
  for (const PlotPoint& point : points) {
    canvas.dot(frame.px(point.x), frame.py(point.y), 3.4, colour);
    if (!point.label.empty()) labels.add(frame.px(point.x), frame.py(point.y), point.label);
  }
  const double y = kTop + 8 + 18 * static_cast<double>(rank), x = frame.box.right + kToLegend;
  canvas.line({{x, y}, {x + 18, y}}, colour, 1.6);
  canvas.dot(x + 9, y, 3.4, colour);
  canvas.text(x + kToName, y + 4, shortened(series.name, kTickSize, kPlotWidth - x - kToName), Anchor::kStart,
              kTickSize, false);
}

// Room for the texts of the ticks on the left, for the names of the series on the right.
Frame frameOf(const Plot& plot, const Axis& x, const Axis& y) {
  double left = 76, right = 180;
  for (const Tick& tick : ticksOf(y)) left = std::max(left, 30 + widthOf(tick.text, kTickSize));
  for (const Series& series : plot.series)
    right = std::max(right, kToLegend + kToName + widthOf(series.name, kTickSize));
  return {x, y, {left, kTop, kPlotWidth - std::min(right, kPlotWidth / 2), kPlotHeight - kBottom}};
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
  const Frame frame = frameOf(plot, axisOf(xs, plot.log_x), axisOf(ys, plot.log_y));
  drawAxes(plot, frame, canvas);
  Labels labels(frame.box, canvas);
  for (std::size_t i = 0; i < plot.series.size(); ++i) drawSeries(plot.series[i], i, frame, labels, canvas);
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
