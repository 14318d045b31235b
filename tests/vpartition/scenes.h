// Scenes whose hypermeshes the tests of vpartition cut.
#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::vpartition::testing {

using Field = std::function<double(double x, double y, double z, double t)>;

// Leaves the surface where the field is 0, inside where it is positive, at `path`.
inline hypermesh::testing::ExtractedMesh extractScene(const std::string& path, std::array<std::uint64_t, 3> dims,
                                                      std::size_t count, const Field& field,
                                                      const AffineMap& map = {}) {
  hypermesh::testing::MemoryFrames<float> frames(dims, count, [&](auto x, auto y, auto z, auto k) {
    return static_cast<float>(
        field(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z), static_cast<double>(k)));
  });
  frames.map(map);
  hypermesh::Options options;
  options.iso = 0;
  options.nan = hypermesh::NanRule::kMask;
  return hypermesh::testing::extractTo(path, frames, options);
}

inline double ballAt(double x, double y, double z, double cx, double cy, double cz, double r) {
  return r - std::hypot(x - cx, y - cy, z - cz);
}

// A ball that moves and grows, away from all walls of space.
inline double movingBall(double x, double y, double z, double t) {
  return ballAt(x, y, z, 12.2 + 0.4 * t, 13.5 - 0.1 * t, 13 + 0.2 * t, 6.4 + 0.15 * t);
}

// Three blobs that meet and part.
inline double blobs(double x, double y, double z, double t) {
  const auto bump = [&](double cx, double cy, double cz, double r) {
    const double d2 = (x - cx) * (x - cx) + (y - cy) * (y - cy) + (z - cz) * (z - cz);
    return std::exp(-d2 / (r * r));
  };
  return bump(9 + 0.6 * t, 12, 12, 5) + bump(19 - 0.6 * t, 14, 13, 5) + bump(14, 9 + 0.7 * t, 17 - 0.3 * t, 4) - 0.5;
}

}  // namespace tet4d::vpartition::testing
