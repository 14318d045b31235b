#include "player/host/stroke_font.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace tet4d::host {
namespace {

// Strokes of ' ' to '~'. A letter is drawn on a grid: x from 0, y from the capitals' top 0 by the small letters' top 4
// to the baseline 12 and the descenders' end 16, two digits (0-9, a-g) a point. Strokes are apart by spaces; of one
// that begins with ~ the points are the control points of a quadratic B-spline that meets both ends.
constexpr std::array<const char*, 95> kGlyphs{
    "", "0008 0b0c", "0003 2023", "1c30 4c60 0464 0868", "~62600006666c0c0a 303c",
    "0c60 ~10202414040010 ~58686c5c4c4858", "~6c1100505408 ~54080c4c68", "0003", "~30050a3e", "~00353a0e",
    "343a 1559 5519", "343a 0767", "1b0e", "0747", "0b0c", "0c60",
    // 0 to 9
    "~30606c3c0c0030", "13303c", "~030060640c 0c6c", "~0200606626 ~26666c0c0a", "4c400969", "600005 ~05656c0c0a",
    "~50000c6c650508", "00602c", "~30606636060030 ~36666c3c0c0636", "~1c6c6000076764",
    // : to @
    "0506 0b0c", "0506 1b0e", "53075b", "0565 0969", "03570b", "~0200606539 3b3c", "~6c0c006068484445",
    // A to Z
    "0c408c 1979", "0c0030 ~30606636 0636 ~36767c3c 0c3c", "~7270000c7c7a", "0c0030 ~30707c3c 3c0c", "60000c6c 0656",
    "60000c 0656", "~7270000c7c77 7747", "000c 707c 0676", "000c", "5059 ~595c0c09", "000c 7008 267c", "000c6c",
    "0c0048808c", "0c007c70", "~40808c4c0c0040", "0c0040 ~40707747 4707", "~40808c4c0c0040 598d",
    "0c0040 ~40707747 4707 477c", "~72700006767c0c0a", "0080 404c", "0008 ~080c7c78 7870", "004c80", "003c507ca0",
    "007c 700c", "0046 8046 464c", "00700c7c",
    // [ to `
    "20000e2e", "006c", "00202e0e", "032043", "0d6d", "0022",
    // a to z
    "~34646c3c0c0434 646c", "~34646c3c0c0434 000c", "~6564040c6c6b", "~34646c3c0c0434 606c", "0868 ~6864040c6c6a",
    "~40202025 252c 0444", "~34646c3c0c0434 646d ~6d6g1g0f", "000c ~08046468 686c", "040c 0001", "242d ~2d2g0g 2021",
    "000c 5409 275c", "000c", "040c ~08045458 585c ~5854a4a8 a8ac", "040c ~08046468 686c", "~34646c3c0c0434",
    "~34646c3c0c0434 040g", "~34646c3c0c0434 646g", "040c ~080444", "~55540408585c0c0b", "~202a2c4c 0444",
    "0408 ~080c6c68 646c", "043c64", "042c446c84", "046c 640c", "043c 641g", "04640c6c",
    // { to ~
    "~30101707 ~07171e3e", "000e", "~00202737 ~37272e0e", "~08254a67"};
constexpr const char* kUnknown = "00606c0c00";
constexpr double kGridLines = 20;  // of a line of text
constexpr double kThickness = 1.5, kGap = 3, kSpace = 5;

struct Point {
  double x = 0, y = 0;
};
using Stroke = std::vector<Point>;
struct Glyph {
  std::vector<Stroke> strokes;
  double width = 0;
};

double digitOf(char c) { return c >= 'a' ? c - 'a' + 10 : c - '0'; }

// Corners cut three times: close to the spline.
Stroke smooth(Stroke stroke) {
  for (int pass = 0; pass < 3; ++pass) {
    Stroke finer{stroke.front()};
    for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
      const Point a = stroke[i], b = stroke[i + 1];
      if (i > 0) finer.push_back({0.75 * a.x + 0.25 * b.x, 0.75 * a.y + 0.25 * b.y});
      if (i + 2 < stroke.size()) finer.push_back({0.25 * a.x + 0.75 * b.x, 0.25 * a.y + 0.75 * b.y});
    }
    finer.push_back(stroke.back());
    stroke = std::move(finer);
  }
  return stroke;
}

Glyph parse(std::string_view text) {
  Glyph glyph;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const bool is_smooth = word.starts_with('~');
    if (is_smooth) word.remove_prefix(1);
    Stroke stroke;
    for (std::size_t i = 0; i + 1 < word.size(); i += 2) {
      stroke.push_back({digitOf(word[i]), digitOf(word[i + 1])});
      glyph.width = std::max(glyph.width, stroke.back().x);
    }
    if (stroke.size() > 1) glyph.strokes.push_back(is_smooth ? smooth(stroke) : stroke);
  }
  return glyph;
}

// The glyph of the character at `at`, which moves behind it.
const Glyph& glyphAt(std::string_view text, std::size_t& at) {
  static const std::vector<Glyph> kAll = [] {
    std::vector<Glyph> all;
    for (const char* strokes : kGlyphs) all.push_back(parse(strokes));
    all.push_back(parse(kUnknown));
    return all;
  }();
  const auto c = static_cast<unsigned char>(text[at++]);
  if (c >= ' ' && c <= '~') return kAll[c - ' '];
  while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) ++at;
  return kAll.back();
}

double advanceOf(const Glyph& glyph) { return glyph.strokes.empty() ? kSpace : glyph.width + kGap; }

double distance(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double s = squared > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0;
  return std::hypot(p.x - a.x - s * dx, p.y - a.y - s * dy);
}

void blend(render::Image& image, std::int64_t x, std::int64_t y, Rgb color, double alpha) {
  std::uint8_t* pixel = image.row(static_cast<std::uint32_t>(y)) + 4 * x;
  for (std::size_t c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + alpha * (color[c] - pixel[c])));
}

// Pixels from .. to - 1 that an interval touches, within 0 .. size.
struct Span {
  std::int64_t from, to;
};
Span pixelsOf(double low, double high, std::uint32_t size) {
  const auto clamped = [&](double x) {
    return static_cast<std::int64_t>(std::clamp(x, 0.0, static_cast<double>(size)));
  };
  return {clamped(std::floor(low)), clamped(std::ceil(high))};
}

void drawGlyph(render::Image& image, const Glyph& glyph, double x, double top, double unit, Rgb color) {
  const double half = std::max(kThickness * unit, 1.0) / 2;
  const Span columns = pixelsOf(x - half - 1, x + glyph.width * unit + half + 1, image.width);
  const Span rows = pixelsOf(top - half - 1, top + 16 * unit + half + 1, image.height);
  for (std::int64_t py = rows.from; py < rows.to; ++py) {
    for (std::int64_t px = columns.from; px < columns.to; ++px) {
      const Point at{(static_cast<double>(px) + 0.5 - x) / unit, (static_cast<double>(py) + 0.5 - top) / unit};
      double nearest = 1e9;
      for (const Stroke& stroke : glyph.strokes) {
        for (std::size_t i = 0; i + 1 < stroke.size(); ++i)
          nearest = std::min(nearest, distance(at, stroke[i], stroke[i + 1]));
      }
      const double cover = std::clamp(half + 0.5 - nearest * unit, 0.0, 1.0);
      if (cover > 0) blend(image, px, py, color, cover);
    }
  }
}

}  // namespace

double textWidth(std::string_view text, double line_px) {
  double units = 0;
  for (std::size_t at = 0; at < text.size();) units += advanceOf(glyphAt(text, at));
  return std::max(0.0, units - kGap) * line_px / kGridLines;
}

void drawText(render::Image& image, double x, double baseline_y, double line_px, std::string_view text, Rgb color) {
  const double unit = line_px / kGridLines;
  for (std::size_t at = 0; at < text.size();) {
    const Glyph& glyph = glyphAt(text, at);
    drawGlyph(image, glyph, x, baseline_y - 12 * unit, unit, color);
    x += advanceOf(glyph) * unit;
  }
}

void fillRectangle(render::Image& image, double left, double top, double right, double bottom, Rgb color,
                   double alpha) {
  const Span columns = pixelsOf(left, right, image.width), rows = pixelsOf(top, bottom, image.height);
  const auto share = [](std::int64_t pixel, double low, double high) {
    return std::max(0.0, std::min(static_cast<double>(pixel) + 1, high) - std::max(static_cast<double>(pixel), low));
  };
  for (std::int64_t y = rows.from; y < rows.to; ++y) {
    for (std::int64_t x = columns.from; x < columns.to; ++x)
      blend(image, x, y, color, alpha * share(x, left, right) * share(y, top, bottom));
  }
}

}  // namespace tet4d::host
