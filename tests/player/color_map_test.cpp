// Maps of colours: their ends, their lightness, and what docs/licences.md says of where they come from.
#include "formats/core/color_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "player/scene/draw_column.h"

namespace tet4d {
namespace {

TEST(ColorMaps, RunFromEndToEndAndClamp) {
  ASSERT_EQ(colorMaps().size(), 6u);
  EXPECT_EQ(findColorMap("no such map"), nullptr);
  EXPECT_EQ(colorMaps()[0].name, "viridis");
  const ColorMap& viridis = *findColorMap("viridis");
  const auto expectColor = [](std::array<float, 3> found, double r, double g, double b) {
    EXPECT_NEAR(255 * found[0], r, 2);
    EXPECT_NEAR(255 * found[1], g, 2);
    EXPECT_NEAR(255 * found[2], b, 2);
  };
  expectColor(viridis.at(0), 68, 1, 84);
  expectColor(viridis.at(0.5f), 33, 145, 140);
  expectColor(viridis.at(1), 253, 231, 37);
  expectColor(viridis.at(-3), 68, 1, 84);
  expectColor(viridis.at(7), 253, 231, 37);
  expectColor(viridis.at(std::numeric_limits<float>::quiet_NaN()), 68, 1, 84);
  expectColor(findColorMap("cool-warm")->at(0.5f), 221, 221, 221);
  expectColor(findColorMap("grey")->at(0.25f), 64, 64, 64);
}

// Luminance of the sequential maps rises all the way: what makes them readable in print.
TEST(ColorMaps, OfOneDirectionGetLighterAllTheWay) {
  for (const ColorMap& map : colorMaps()) {
    if (map.name == "cool-warm") continue;
    const scene::DrawColumn column = scene::makeDrawColumn(0, 1, 0, 0, 1, map);
    for (std::size_t i = 1; i < column.table.size(); ++i) {
      const glm::vec3 weights(0.2126f, 0.7152f, 0.0722f);
      EXPECT_GE(glm::dot(weights, column.table[i]), glm::dot(weights, column.table[i - 1])) << map.name << ' ' << i;
    }
  }
}

// Moreland 2009, Diverging Color Maps for Scientific Visualization: polar coordinates of CIELAB (Msh), and between the
// two ends the way by way of white.
class Diverging {
 public:
  Diverging(glm::dvec3 from, glm::dvec3 to) : from_(polar(lab(from))), to_(polar(lab(to))) {}
  glm::dvec3 at(double s) const {
    glm::dvec3 a = from_, b = to_;
    const double middle = std::max({a[0], b[0], 88.0});
    if (s < 0.5) {
      b = {middle, 0, hueTowards(a, middle)};
      s = 2 * s;
    } else {
      a = {middle, 0, hueTowards(b, middle)};
      s = 2 * s - 1;
    }
    return srgb((1 - s) * a + s * b);
  }

 private:
  // Columns: what red, green and blue of linear sRGB are in XYZ; the white of D65.
  static constexpr glm::dmat3 kToXyz{{0.4124, 0.2126, 0.0193}, {0.3576, 0.7152, 0.1192}, {0.1805, 0.0722, 0.9505}};
  static glm::dvec3 white() { return kToXyz * glm::dvec3(1); }
  static glm::dvec3 lab(glm::dvec3 bytes) {
    for (int c = 0; c < 3; ++c) {
      const double v = bytes[c] / 255;
      bytes[c] = v > 0.04045 ? std::pow((v + 0.055) / 1.055, 2.4) : v / 12.92;
    }
    glm::dvec3 f = kToXyz * bytes / white();
    for (int c = 0; c < 3; ++c) f[c] = f[c] > 0.008856 ? std::cbrt(f[c]) : 7.787 * f[c] + 16.0 / 116;
    return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
  }
  static glm::dvec3 polar(const glm::dvec3& lab) {
    const double length = glm::length(lab);
    return {length, std::acos(lab[0] / length), std::atan2(lab[2], lab[1])};
  }
  // The hue at white that a saturated colour turns to, so that saturation falls evenly.
  static double hueTowards(const glm::dvec3& color, double middle) {
    if (color[0] >= middle - 0.1) return color[2];
    const double spin = color[1] * std::sqrt(middle * middle - color[0] * color[0]) / (color[0] * std::sin(color[1]));
    return color[2] > -0.3 * std::acos(-1) ? color[2] + spin : color[2] - spin;
  }
  static glm::dvec3 srgb(const glm::dvec3& msh) {
    const double lightness = msh[0] * std::cos(msh[1]), chroma = msh[0] * std::sin(msh[1]);
    const double y = (lightness + 16) / 116;
    glm::dvec3 f{y + chroma * std::cos(msh[2]) / 500, y, y - chroma * std::sin(msh[2]) / 200};
    for (int c = 0; c < 3; ++c) f[c] = f[c] > 0.206893 ? f[c] * f[c] * f[c] : (f[c] - 16.0 / 116) / 7.787;
    glm::dvec3 color = glm::inverse(kToXyz) * (f * white());
    for (int c = 0; c < 3; ++c) {
      const double v = std::max(color[c], 0.0);
      color[c] = 255 * (v > 0.0031308 ? 1.055 * std::pow(v, 1 / 2.4) - 0.055 : 12.92 * v);
    }
    return color;
  }
  glm::dvec3 from_, to_;
};

TEST(ColorMaps, CoolWarmIsMorelandsFormula) {
  const ColorMap& map = *findColorMap("cool-warm");
  const Diverging formula({59, 76, 192}, {180, 4, 38});
  for (std::size_t k = 0; k < map.knots.size(); ++k) {
    const glm::dvec3 color = formula.at(static_cast<double>(k) / static_cast<double>(map.knots.size() - 1));
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ((map.knots[k] >> (16 - 8 * c)) & 0xff, static_cast<unsigned>(std::lround(color[c]))) << k << ' ' << c;
  }
}

TEST(ColorMaps, GreyIsEvenStepsOfSrgb) {
  const ColorMap& map = *findColorMap("grey");
  for (std::size_t k = 0; k < map.knots.size(); ++k)
    EXPECT_EQ(map.knots[k], 0x10101u * static_cast<unsigned>(std::lround(255.0 * static_cast<double>(k) / 32))) << k;
}

}  // namespace
}  // namespace tet4d
