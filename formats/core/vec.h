// Plain vectors and boxes as they stand in files. No arithmetic library: GLM serves libpreprocess and the player.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace tet4d {

struct Vec3f {
  float x, y, z;
  friend bool operator==(const Vec3f&, const Vec3f&) = default;
};

// A point of space-time: x, y, z in grid cells (or relative to the file's origin), t in frames.
struct Vec4f {
  float x, y, z, t;
  friend bool operator==(const Vec4f&, const Vec4f&) = default;
};

static_assert(sizeof(Vec3f) == 12 && std::is_trivially_copyable_v<Vec3f>);
static_assert(sizeof(Vec4f) == 16 && std::is_trivially_copyable_v<Vec4f>);

// An axis-aligned box of space-time. Empty: min > max.
struct Bounds4f {
  Vec4f min{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
            std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
  Vec4f max{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
            -std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z && min.t <= max.t); }
  void add(const Vec4f& p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z), std::min(min.t, p.t)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z), std::max(max.t, p.t)};
  }
  void add(const Bounds4f& b) {
    if (!b.empty()) add(b.min), add(b.max);
  }
};

}  // namespace tet4d
