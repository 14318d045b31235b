#include "player/host/legend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace tet4d::host {
namespace {

constexpr std::size_t kMostEntries = scene::kPartColors;

Rgb rgbOf(const glm::vec3& linear) {
  return {render::toSrgb8(linear.x), render::toSrgb8(linear.y), render::toSrgb8(linear.z)};
}

// A number with as many digits as `step` needs.
std::string numberText(double value, double step) {
  std::array<char, 40> text{};
  const double largest = std::max(std::abs(value), step);
  if (value != 0 && (largest >= 1e6 || step < 1e-4)) {
    const auto power = [](double x) { return static_cast<int>(std::floor(std::log10(x) + 1e-9)); };
    const int digits = power(std::abs(value)) - power(step);
    std::snprintf(text.data(), text.size(), "%.*e", std::clamp(digits, 0, 8), value);
    std::string written = text.data();
    // 1.5e-07 as 1.5e-7.
    const std::size_t e = written.find('e');
    const std::string exponent = std::to_string(std::stoi(written.substr(e + 1)));
    return written.substr(0, e + 1) + exponent;
  }
  const int decimals = step > 0 ? static_cast<int>(std::max(0.0, std::ceil(-std::log10(step) - 1e-9))) : 3;
  std::snprintf(text.data(), text.size(), "%.*f", std::min(decimals, 9), value == 0 ? 0.0 : value);
  return text.data();
}

// The smallest of 1, 2, 5 times a power of ten that is at least x.
double roundStep(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= x * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

std::vector<Tick> evenTicks(double low, double high, std::size_t most) {
  std::vector<Tick> ticks;
  // In halves: the difference of two floats may exceed the largest one, not of two doubles.
  const double step = roundStep((high - low) / static_cast<double>(most));
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && ticks.size() <= most + 1; ++k)
    ticks.push_back({std::clamp((k * step - low) / (high - low), 0.0, 1.0), numberText(k * step, step)});
  return ticks;
}

std::vector<Tick> powerTicks(double low, double high, std::size_t most) {
  const double from = std::log10(low), span = std::log10(high) - from;
  std::vector<Tick> ticks;
  const auto add = [&](double value) {
    const double place = (std::log10(value) - from) / span;
    if (place < -1e-9 || place > 1 + 1e-9) return;
    ticks.push_back(
        {std::clamp(place, 0.0, 1.0), numberText(value, std::pow(10, std::floor(std::log10(value) + 1e-9)))});
  };
  const auto first = static_cast<int>(std::floor(from)), last = static_cast<int>(std::ceil(from + span));
  // 1, 2, 5 of each power where they fit; else the powers, or every so many of them.
  const bool is_fine = 3 * span <= static_cast<double>(most);
  const int stride = std::max(1, static_cast<int>(std::ceil(span / static_cast<double>(most))));
  for (int power = first; power <= last; power += is_fine ? 1 : stride) {
    add(std::pow(10, power));
    if (is_fine) add(2 * std::pow(10, power)), add(5 * std::pow(10, power));
  }
  return ticks;
}

// Sizes of a legend in lines of text.
struct Measure {
  double width = 0, height = 0;
};
constexpr double kPadding = 0.7, kBarWidth = 1.1, kBarLines = 10, kSwatch = 1.0, kLineStep = 1.35, kMarginLines = 0.8;

std::string shortened(const std::string& text, double most_lines) {
  std::string cut = text;
  while (cut.size() > 4 && textWidth(cut, 1) > most_lines)
    cut = cut.substr(0, cut.size() - (cut.ends_with("...") ? 4 : 1)) + "...";
  return cut;
}

double headLines(const Legend& legend) { return kLineStep * (legend.note.empty() ? 1 : 2) + 0.3; }

std::size_t ticksFor(double bar_lines) { return static_cast<std::size_t>(std::clamp(bar_lines / 1.8, 2.0, 8.0)); }

Measure measure(const Legend& legend, double bar_lines) {
  double width = std::max(textWidth(legend.title, 1), textWidth(legend.note, 1));
  double height = headLines(legend);
  if (legend.bar.empty()) {
    for (const Legend::Entry& entry : legend.entries)
      width = std::max(width, kSwatch + 0.5 + textWidth(entry.label, 1));
    height += kLineStep * static_cast<double>(legend.entries.size());
  } else {
    for (const Tick& tick : ticksOf(legend.low, legend.high, legend.logarithmic, ticksFor(bar_lines)))
      width = std::max(width, kBarWidth + 0.65 + textWidth(tick.label, 1));
    height += bar_lines + 0.4;
  }
  return {width + 2 * kPadding, height + 2 * kPadding};
}

struct Ink {
  Rgb paper, letters, line;
};

void drawBar(render::Image& image, const Legend& legend, double left, double top, double line, double bar_lines,
             const Ink& ink) {
  // On whole pixels: a row that covers two by halves would let what is behind it through.
  left = std::round(left), top = std::round(top);
  const double height = std::round(bar_lines * line), width = std::round(kBarWidth * line);
  fillRectangle(image, left - 1, top - 1, left + width + 1, top + height + 1, ink.line, 1);
  const auto rows = static_cast<std::size_t>(std::lround(height));
  for (std::size_t row = 0; row < rows; ++row) {
    const double part = 1 - (static_cast<double>(row) + 0.5) / static_cast<double>(rows);
    const auto entry = static_cast<std::size_t>(std::lround(part * static_cast<double>(legend.bar.size() - 1)));
    const double y = top + static_cast<double>(row) * height / static_cast<double>(rows);
    fillRectangle(image, left, y, left + width, y + height / static_cast<double>(rows), legend.bar[entry], 1);
  }
  for (const Tick& tick : ticksOf(legend.low, legend.high, legend.logarithmic, ticksFor(bar_lines))) {
    const double y = top + (1 - tick.place) * height, thickness = std::max(1.0, line / 16);
    fillRectangle(image, left + width, y - thickness / 2, left + width + 0.35 * line, y + thickness / 2, ink.letters,
                  1);
    drawText(image, left + width + 0.6 * line, y + 0.3 * line, line, tick.label, ink.letters);
  }
}

void drawLegend(render::Image& image, const Legend& legend, double left, double top, const Measure& size, double line,
                double bar_lines, const Ink& ink) {
  fillRectangle(image, left, top, left + size.width * line, top + size.height * line, ink.paper, 0.82);
  const double x = left + kPadding * line;
  double y = top + kPadding * line;
  drawText(image, x, y + 0.75 * line, line, legend.title, ink.letters);
  if (!legend.note.empty()) drawText(image, x, y + (kLineStep + 0.75) * line, line, legend.note, ink.line);
  y += headLines(legend) * line;
  if (!legend.bar.empty()) return drawBar(image, legend, x, y + 0.2 * line, line, bar_lines, ink);
  for (const Legend::Entry& entry : legend.entries) {
    const bool has_color = entry.label != "...";
    const double left_px = std::round(x), top_px = std::round(y), side = std::round(kSwatch * line);
    if (has_color) {
      fillRectangle(image, left_px - 1, top_px - 1, left_px + side + 1, top_px + side + 1, ink.line, 1);
      fillRectangle(image, left_px, top_px, left_px + side, top_px + side, entry.color, 1);
    }
    drawText(image, x + (kSwatch + 0.5) * line, y + 0.8 * line, line, entry.label, ink.letters);
    y += kLineStep * line;
  }
}

}  // namespace

std::vector<Tick> ticksOf(double low, double high, bool logarithmic, std::size_t most) {
  if (!(high > low) || !std::isfinite(low) || !std::isfinite(high)) {
    if (low == 0) return {{0.5, "0"}};
    const double scale = std::max(std::abs(low), 1e-30);
    return {{0.5, numberText(low, roundStep(scale * 1e-3))}};
  }
  std::vector<Tick> ticks = logarithmic && low > 0 ? powerTicks(low, high, most) : evenTicks(low, high, most);
  if (ticks.size() >= 2) return ticks;
  // Less than two round numbers lie within: the ends.
  const double step = roundStep((high - low) * 0.1);
  return {{0, numberText(low, step)}, {1, numberText(high, step)}};
}

std::vector<Legend> legendOf(const dyntri::File& file, const scene::Coloring& coloring, const scene::DrawColumn* drawn,
                             std::string_view note) {
  if (drawn == nullptr) return {};
  Legend legend;
  legend.note = note;
  if (drawn->of_parts) {
    legend.title = "parts";
    const std::size_t parts = std::max<std::size_t>(1, file.parts().size());
    for (std::size_t part = 0; part < std::min(parts, kMostEntries); ++part)
      legend.entries.push_back({rgbOf(drawn->table[part % scene::kPartColors]), scene::partName(file, part)});
    if (parts > kMostEntries) legend.entries.push_back({{}, "..."});
    return {legend};
  }
  legend.title = scene::valueName(file, coloring.column, coloring.component);
  for (const glm::vec3& color : drawn->table) legend.bar.push_back(rgbOf(color));
  legend.low = double{drawn->low}, legend.high = double{drawn->high};
  legend.logarithmic = drawn->logarithmic;
  return {legend};
}

double legendLine(std::uint32_t width, std::uint32_t height) { return std::max(10.0, std::min(width, height) / 36.0); }

namespace {

struct Placed {
  Legend legend;  // cut to what fits
  Measure size;
  double left = 0, top = 0, bar_lines = 0;
};

std::vector<Placed> place(std::span<const Legend> legends, const scene::Frame& within, double line_px) {
  std::vector<Placed> placed;
  const double margin = kMarginLines * line_px, most_width = within.width / line_px - 2 * kMarginLines;
  double right = within.left + within.width - margin;
  for (const Legend& given : legends) {
    Legend legend = given;
    legend.title = shortened(legend.title, most_width - 2 * kPadding);
    legend.note = shortened(legend.note, std::max(8.0, textWidth(legend.title, 1)));
    const double free_lines = within.height / line_px - 1.6 - headLines(legend) - 2 * kPadding - 0.4;
    const double bar_lines = std::min(kBarLines, free_lines);
    if (bar_lines < 3) return placed;
    while (legend.bar.empty() && legend.entries.size() > 1 &&
           kLineStep * static_cast<double>(legend.entries.size()) > free_lines) {
      legend.entries.pop_back();
      legend.entries.back() = {{}, "..."};
    }
    const Measure size = measure(legend, bar_lines);
    const double left = right - size.width * line_px;
    if (left < within.left + margin - 1) return placed;
    const double top = within.top + (within.height - size.height * line_px) / 2;
    placed.push_back({std::move(legend), size, left, top, bar_lines});
    right = left - margin;
  }
  return placed;
}

}  // namespace

void drawLegends(render::Image& image, std::span<const Legend> legends, const scene::Frame& within, double line_px,
                 bool dark) {
  const Ink ink =
      dark ? Ink{{18, 22, 27}, {232, 236, 240}, {140, 150, 160}} : Ink{{255, 255, 255}, {28, 32, 38}, {110, 118, 126}};
  for (const Placed& one : place(legends, within, line_px))
    drawLegend(image, one.legend, std::round(one.left), std::round(one.top), one.size, line_px, one.bar_lines, ink);
}

double legendsWidth(std::span<const Legend> legends, const scene::Frame& within, double line_px) {
  const std::vector<Placed> placed = place(legends, within, line_px);
  return placed.empty() ? 0 : within.left + within.width - placed.back().left + kMarginLines * line_px;
}

bool isDark(const scene::Background& background) { return background.top.y + background.bottom.y < 1; }

}  // namespace tet4d::host
