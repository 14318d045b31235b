#include "tools/report/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tet4d::report {
namespace {

constexpr double kNarrowest = 1e-3;  // of the values themselves

std::vector<double> decadesOf(const Axis& axis) {
  const double decades = axis.high - axis.low;
  const int step = std::max(1, static_cast<int>(std::ceil(decades / 8)));
  std::vector<double> values;
  for (int e = static_cast<int>(std::ceil(axis.low)); e <= axis.high; ++e) {
    if (e % step == 0) values.push_back(std::pow(10.0, e));
  }
  return values;
}

std::vector<double> partsOfDecades(const Axis& axis) {
  std::vector<double> values;
  for (int e = static_cast<int>(std::floor(axis.low)); e <= axis.high; ++e) {
    for (const double m : {1.0, 2.0, 5.0}) {
      const double value = m * std::pow(10.0, e), at = std::log10(value);
      if (at >= axis.low && at <= axis.high) values.push_back(value);
    }
  }
  return values;
}

// At least three for any low < high: no step is above 1.5 fifths.
std::vector<double> linearSteps(double low, double high) {
  const double raw = (high - low) / 5, unit = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = raw / unit < 1.5 ? unit : raw / unit < 3.5 ? 2 * unit : raw / unit < 7.5 ? 5 * unit : 10 * unit;
  std::vector<double> values;
  for (double k = std::ceil(low / step); k * step <= high; ++k) values.push_back(k * step);
  return values;
}

std::vector<double> valuesOf(const Axis& axis) {
  if (!axis.log) return linearSteps(axis.low, axis.high);
  const double decades = axis.high - axis.low;
  std::vector<double> values;
  if (decades > 2.5) values = decadesOf(axis);
  if (values.size() < 2 && decades >= std::log10(2.0)) values = partsOfDecades(axis);
  if (values.size() < 2) values = linearSteps(std::pow(10.0, axis.low), std::pow(10.0, axis.high));
  return values;
}

// As few digits as tell the values from one another.
std::vector<std::string> textsOf(const std::vector<double>& values) {
  const double step = values.size() > 1 ? values[1] - values[0] : 0;
  std::vector<std::string> texts(values.size());
  for (int digits = 3; digits <= 12; ++digits) {
    bool right = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
      texts[i] = fmt::format("{:.{}g}", values[i], digits);
      right = right && std::abs(std::stod(texts[i]) - values[i]) <= 0.01 * step;
    }
    if (right) break;
  }
  return texts;
}

}  // namespace

bool Axis::shows(double value) const { return std::isfinite(value) && (!log || value > 0); }

double Axis::place(double value) const {
  const double v = log ? std::log10(value) : value;
  return (v - low) / (high - low);
}

Axis axisOf(const std::vector<double>& values, bool log) {
  Axis axis{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), log};
  for (const double value : values) {
    const double v = log ? std::log10(value) : value;
    axis.low = std::min(axis.low, v);
    axis.high = std::max(axis.high, v);
  }
  if (values.empty()) axis.low = 0, axis.high = 1;
  if (!log) axis.low = std::min(axis.low, 0.0);
  double margin = 0.06 * (axis.high - axis.low);
  if (axis.high == axis.low) {
    margin = log || axis.low == 0 ? 0.5 : 0.5 * std::abs(axis.low);
  } else {
    const double least = log ? std::log10(1 + kNarrowest) : kNarrowest * std::abs(axis.low);
    margin = std::max(margin, (least - (axis.high - axis.low)) / 2);
  }
  axis.low -= log ? margin : 0;
  axis.high += margin;
  return axis;
}

std::vector<Tick> ticksOf(const Axis& axis) {
  std::vector<double> values = valuesOf(axis);
  std::vector<std::string> texts = textsOf(values);
  std::vector<Tick> ticks;
  for (std::size_t i = 0; i < values.size(); ++i) ticks.push_back({values[i], std::move(texts[i])});
  return ticks;
}

}  // namespace tet4d::report
