#include <algorithm>
#include <cmath>
#include <numbers>

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

std::array<double, 3> Ball::centreAt(double time) const {
  return {centre[0] + velocity[0] * time, centre[1] + velocity[1] * time, centre[2] + velocity[2] * time};
}

double Ball::radiusAt(double time) const { return radius + growth * time; }

void Ball::write(const std::string& path) const {
  outofcore::OutputFile file(path, true);
  const double step = 1 / static_cast<double>(samples - 1);
  std::vector<float> row(samples);
  std::uint64_t rank = 0;
  for (std::size_t k = 0; k < frames; ++k) {
    const double time = static_cast<double>(k) / static_cast<double>(frames - 1), size = radiusAt(time);
    const auto middle = centreAt(time);
    for (std::size_t z = 0; z < samples; ++z) {
      for (std::size_t y = 0; y < samples; ++y) {
        const double dy = static_cast<double>(y) * step - middle[1], dz = static_cast<double>(z) * step - middle[2];
        for (std::size_t x = 0; x < samples; ++x) {
          const double dx = static_cast<double>(x) * step - middle[0];
          const double field = size - std::sqrt(dx * dx + dy * dy + dz * dz);
          row[x] = static_cast<float>(field + noise * step * noiseOf(rank++));
        }
        file.write(std::as_bytes(std::span(row)));
      }
    }
  }
  file.commit();
}

void Blobs::write(const std::string& path) const {
  constexpr std::size_t kBlobs = 12;
  constexpr double kTurn = 2 * std::numbers::pi;
  std::uint64_t rank = 1'000'003;
  const auto within = [&](double low, double high) { return low + (high - low) * 0.5 * (1 + noiseOf(rank++)); };
  struct Blob {
    std::array<double, 3> centre, reach, phase;
    double turns, width;
  };
  std::array<Blob, kBlobs> blobs{};
  for (std::size_t i = 0; i < kBlobs; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      blobs[i].centre[c] = within(0.35, 0.65);
      blobs[i].reach[c] = within(0.05, 0.15);
      blobs[i].phase[c] = within(0, kTurn);
    }
    blobs[i].turns = i % 2 == 0 ? 1 : 2;
    blobs[i].width = within(0.04, 0.08);
  }
  outofcore::OutputFile file(path, true);
  const double step = 1 / static_cast<double>(samples - 1);
  std::vector<float> field(samples * samples * samples);
  std::array<std::vector<double>, 3> bells;
  for (auto& bell : bells) bell.resize(samples);
  for (std::size_t k = 0; k < frames; ++k) {
    const double time = static_cast<double>(k) / static_cast<double>(frames - 1);
    std::fill(field.begin(), field.end(), 0.0F);
    for (const Blob& blob : blobs) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double at = blob.centre[c] + blob.reach[c] * std::sin(kTurn * blob.turns * time + blob.phase[c]);
        for (std::size_t i = 0; i < samples; ++i)
          bells[c][i] = std::exp(-std::pow((static_cast<double>(i) * step - at) / blob.width, 2) / 2);
      }
      float* out = field.data();
      for (const double z : bells[2]) {
        for (const double y : bells[1]) {
          for (const double x : bells[0]) *out++ += static_cast<float>(x * y * z);
        }
      }
    }
    file.write(std::as_bytes(std::span(field)));
  }
  file.commit();
}

}  // namespace tet4d::report
