#include <cmath>

#include "libpreprocess/outofcore/output_file.h"
#include "tools/report/sweeps.h"

namespace tet4d::report {
namespace {

// Evenly spread in -1 … 1, the same on every machine.
double noiseOf(std::uint64_t k) {
  k += 0x9e3779b97f4a7c15U;
  k = (k ^ (k >> 30)) * 0xbf58476d1ce4e5b9U;
  k = (k ^ (k >> 27)) * 0x94d049bb133111ebU;
  k ^= k >> 31;
  return static_cast<double>(k >> 11) / 4503599627370496.0 - 1;
}

}  // namespace

// Off the lattice of every stride, and along no axis.
std::array<double, 3> Ball::centreAt(double time) const {
  return {0.413 + 0.171 * time, 0.447 + 0.097 * time, 0.551 - 0.073 * time};
}

double Ball::radiusAt(double time) const { return 0.263 + 0.031 * time; }

void Ball::write(const std::string& path) const {
  outofcore::OutputFile file(path, true);
  const double step = 1 / static_cast<double>(samples - 1);
  std::vector<float> row(samples);
  std::uint64_t rank = 0;
  for (std::size_t k = 0; k < frames; ++k) {
    const double time = static_cast<double>(k) / static_cast<double>(frames - 1), radius = radiusAt(time);
    const auto centre = centreAt(time);
    for (std::size_t z = 0; z < samples; ++z) {
      for (std::size_t y = 0; y < samples; ++y) {
        const double dy = static_cast<double>(y) * step - centre[1], dz = static_cast<double>(z) * step - centre[2];
        for (std::size_t x = 0; x < samples; ++x) {
          const double dx = static_cast<double>(x) * step - centre[0];
          const double field = radius - std::sqrt(dx * dx + dy * dy + dz * dz);
          row[x] = static_cast<float>(field + noise * step * noiseOf(rank++));
        }
        file.write(std::as_bytes(std::span(row)));
      }
    }
  }
  file.commit();
}

}  // namespace tet4d::report
