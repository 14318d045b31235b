// What a plot is drawn on. Private to tools/report.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tet4d::report {

inline constexpr double kPlotWidth = 690, kPlotHeight = 420;

enum class Anchor { kStart, kMiddle, kEnd };

// Units are pixels, y grows downwards; colours are "#rrggbb".
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void line(const std::vector<std::pair<double, double>>& points, const std::string& colour, double width) = 0;
  virtual void dot(double x, double y, double radius, const std::string& colour) = 0;
  // upwards: turned by 90 degrees to the left.
  virtual void text(double x, double y, const std::string& text, Anchor anchor, double size, bool upwards) = 0;
};

struct Plot;
void draw(const Plot& plot, Canvas& canvas);

}  // namespace tet4d::report
