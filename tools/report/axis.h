// An axis of a plot: which values it spans, where they lie on it, and the ticks that let a reader tell them.
#pragma once

#include <string>
#include <vector>

namespace tet4d::report {

struct Axis {
  double low = 0, high = 1;  // in logarithms if log
  bool log = false;

  bool shows(double value) const;
  double place(double value) const;  // 0 at low, 1 at high
};

// Spans the values, all of which it shows, and a margin; linear ones begin at zero. Never so narrow that ticks could
// not be told apart.
Axis axisOf(const std::vector<double>& values, bool log);

struct Tick {
  double value;
  std::string text;
};

// At least two, in order, their texts different: decades, where those are too few 1-2-5 of each, where a logarithmic
// axis spans less than that linear steps.
std::vector<Tick> ticksOf(const Axis& axis);

}  // namespace tet4d::report
