// Plots: figures over figures, on linear or logarithmic axes, drawn by one code as SVG and, where the build has cairo,
// PNG.
#pragma once

#include <string>
#include <vector>

namespace tet4d::report {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  // beside the point, may be empty
};

struct Series {
  std::string name;
  std::vector<PlotPoint> points;  // joined in the order of x: no curve goes backwards
};

struct Plot {
  std::string name;  // of its files, without suffix
  std::string title, x_label, y_label;
  bool log_x = true, log_y = true;  // points that a logarithm cannot show are left out, and counted below the plot
  std::vector<Series> series;       // at most eight keep colours of their own
};

// The whole document. The same bytes for the same plot.
std::string svgOf(const Plot& plot);

bool hasPng();
// Throws Error{kNotBuilt} without cairo, kIo where the file cannot be written.
void writePng(const Plot& plot, const std::string& path);

}  // namespace tet4d::report
