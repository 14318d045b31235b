// A stretch of frames that is in memory as one, and which vertices are kept at which of them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/vec.h"

namespace tet4d::prisms {

inline constexpr unsigned kMostSteps = 63;  // a window's frames are bits of a word

// Bit f: the vertex is kept at the window's frame f. Of a vertex in a triangle the first and the last are set; of
// others none is.
using Kept = std::uint64_t;

struct Window {
  std::uint64_t begin = 0;                 // number of its first frame
  unsigned steps = 0;                      // frames are begin .. begin + steps
  std::vector<std::vector<Vec3f>> frames;  // at least steps + 1, all vertices each
  Kept all() const { return (Kept{2} << steps) - 1; }
};

// Lengths in the world of vectors in index space.
class WorldLength {
 public:
  explicit WorldLength(const AffineMap& map) : axes_(map.axes) {}
  double squared(double x, double y, double z) const {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double w = x * axes_[0][c] + y * axes_[1][c] + z * axes_[2][c];
      sum += w * w;
    }
    return sum;
  }
  // No vector grows by more.
  double most() const {
    double sum = 0;
    for (const auto& axis : axes_) sum += axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
    return std::sqrt(sum);
  }

 private:
  std::array<std::array<double, 3>, 3> axes_;
};

// How far, squared, the edge from `low` at frame l to `high` at frame h passes from where the same point of the true
// edge (or, low = high, the vertex) is at frame f, l < f < h. Frames of the window; world units.
inline double missSquared(const Window& window, const WorldLength& length, std::uint32_t low, unsigned l,
                          std::uint32_t high, unsigned h, unsigned f) {
  const double s = static_cast<double>(f - l) / static_cast<double>(h - l);
  const Vec3f &from = window.frames[l][low], &to = window.frames[h][high];
  const Vec3f &low_now = window.frames[f][low], &high_now = window.frames[f][high];
  const auto miss = [s](float a, float a_now, float b, float b_now) {
    return (1 - s) * (double{a} - double{a_now}) + s * (double{b} - double{b_now});
  };
  return length.squared(miss(from.x, low_now.x, to.x, high_now.x), miss(from.y, low_now.y, to.y, high_now.y),
                        miss(from.z, low_now.z, to.z, high_now.z));
}

}  // namespace tet4d::prisms
