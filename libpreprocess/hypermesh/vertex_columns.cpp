#include "libpreprocess/hypermesh/vertex_columns.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tet4d::hypermesh {
namespace {

// 4D cross product of the tetrahedron's edges with t stretched by frame_time.
Normal4 normalOf(const std::array<const Vec4f*, 4>& p, double frame_time) {
  std::array<std::array<double, 4>, 3> e{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec4f &a = *p[0], &b = *p[k + 1];
    e[k] = {double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z, (double{b.t} - a.t) * frame_time};
  }
  const auto minor = [&](std::size_t i, std::size_t j, std::size_t k) {
    return e[0][i] * (e[1][j] * e[2][k] - e[1][k] * e[2][j]) - e[0][j] * (e[1][i] * e[2][k] - e[1][k] * e[2][i]) +
           e[0][k] * (e[1][i] * e[2][j] - e[1][j] * e[2][i]);
  };
  return {minor(1, 2, 3), -minor(0, 2, 3), minor(0, 1, 3), -minor(0, 1, 2)};
}

std::int64_t clampTo(std::int64_t index, std::uint64_t count) {
  return std::clamp<std::int64_t>(index, 0, static_cast<std::int64_t>(count) - 1);
}

// A lattice point of a frame as a sample, moved to the nearest one.
struct SamplePoint {
  std::array<std::int64_t, 3> at;
  std::size_t frame;
};

SamplePoint endOf(const GridShape& shape, const LatticeEdge& edge, bool tip) {
  SamplePoint point{};
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<std::int64_t>(edge.base[axis] + (tip ? edge.axes >> axis & 1U : 0));
    point.at[axis] = clampTo(index - static_cast<std::int64_t>(shape.pad), shape.samples(axis));
  }
  point.frame = edge.frame + (tip ? edge.axes >> 3 & 1U : 0);
  return point;
}

double valueAt(const GridShape& shape, const FieldFrames& field, const SamplePoint& point) {
  const auto& at = point.at;
  const std::size_t i =
      (static_cast<std::size_t>(at[2]) * shape.samples(1) + static_cast<std::size_t>(at[1])) * shape.samples(0) +
      static_cast<std::size_t>(at[0]);
  return field.kernels.value(field.samples(point.frame), i);
}

// Slope through up to three values at places, the middle one the point's own; 0 if none can be told.
double slope(double before, double middle, double after, double place_before, double place, double place_after) {
  const bool has_before = std::isfinite(before) && place_before < place;
  const bool has_after = std::isfinite(after) && place_after > place;
  if (has_before && has_after) return (after - before) / (place_after - place_before);
  if (!std::isfinite(middle)) return 0;
  if (has_before) return (middle - before) / (place - place_before);
  return has_after ? (after - middle) / (place_after - place) : 0;
}

Normal4 gradientAt(const GridShape& shape, const FieldFrames& field, std::span<const double> times, std::size_t count,
                   const SamplePoint& point) {
  Normal4 gradient{};
  const double middle = valueAt(shape, field, point);
  for (unsigned axis = 0; axis < 3; ++axis) {
    SamplePoint before = point, after = point;
    before.at[axis] = clampTo(point.at[axis] - 1, shape.samples(axis));
    after.at[axis] = clampTo(point.at[axis] + 1, shape.samples(axis));
    gradient[axis] =
        slope(valueAt(shape, field, before), middle, valueAt(shape, field, after), static_cast<double>(before.at[axis]),
              static_cast<double>(point.at[axis]), static_cast<double>(after.at[axis]));
  }
  SamplePoint before = point, after = point;
  before.frame = point.frame == 0 ? 0 : point.frame - 1;
  after.frame = std::min(point.frame + 1, count - 1);
  gradient[3] = slope(valueAt(shape, field, before), middle, valueAt(shape, field, after), times[before.frame],
                      times[point.frame], times[after.frame]);
  return gradient;
}

double coordinate(const Vec4f& p, unsigned axis) { return axis == 0 ? p.x : axis == 1 ? p.y : axis == 2 ? p.z : p.t; }

}  // namespace

NormalMap::NormalMap(const AffineMap& map, double diagonal) : diagonal_(diagonal) {
  const auto& a = map.axes;
  const double volume = cellVolume(map);
  for (std::size_t i = 0; i < 3; ++i) {
    // Rows of the inverse are the cross products of the other two axes over the volume: covectors of the index axes.
    const auto &u = a[(i + 1) % 3], &v = a[(i + 2) % 3];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
      inverse_transposed_[i][c] = (u[d] * v[e] - u[e] * v[d]) / volume;
    }
  }
}

void NormalMap::columns(const Normal4& n, double frame_time, float* normal, float* velocity) const {
  std::array<double, 3> world{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t c = 0; c < 3; ++c) world[c] += n[i] * inverse_transposed_[i][c];
  const double length = std::hypot(world[0], world[1], world[2]);
  const bool has_normal = length > 0 && std::isfinite(length);
  // As -n_t / |n| overflows where |n| is nearly nothing, the bound comes first.
  const double most = diagonal_ / frame_time;
  double speed = has_normal ? -n[3] / length : 0;
  if (!std::isfinite(speed)) speed = std::signbit(n[3]) ? most : -most;
  speed = std::isnan(n[3]) ? 0 : std::clamp(speed, -most, most);
  for (std::size_t c = 0; c < 3; ++c) {
    const double unit = has_normal ? world[c] / length : 0;
    if (normal != nullptr) normal[c] = static_cast<float>(unit);
    if (velocity != nullptr) velocity[c] = static_cast<float>(unit * speed);
  }
}

void NormalSums::add(std::span<const Tet> tets, std::span<const std::uint64_t> layers, std::span<const Vec4f> own,
                     std::span<const Vec4f> next, double frame_time, outofcore::Executor& executor) {
  extendTo(own.size() + next.size());
  // A layer's vertices are its own and the next layer's: every other layer at a time, and no two tasks meet.
  for (std::size_t parity = 0; parity < 2; ++parity) {
    const std::size_t tasks = (layers.size() - 1 + 1 - parity) / 2;
    executor.run(tasks, [&](std::size_t task) {
      const std::size_t z = 2 * task + parity;
      for (std::uint64_t i = layers[z]; i < layers[z + 1]; ++i) {
        std::array<const Vec4f*, 4> corners{};
        for (std::size_t c = 0; c < 4; ++c) {
          const std::uint32_t v = tets[i][c];
          corners[c] = v < own.size() ? &own[v] : &next[v - own.size()];
        }
        const Normal4 n = normalOf(corners, frame_time);
        for (const std::uint32_t v : tets[i])
          for (std::size_t c = 0; c < 4; ++c) sums_[v][c] += n[c];
      }
    });
  }
}

void NormalSums::advance(std::size_t own) {
  sums_.erase(sums_.begin(), sums_.begin() + static_cast<std::ptrdiff_t>(own));
}

void forEachEdge(const GridShape& shape, const EdgeSet& set, std::size_t frame, std::span<const Vec4f> positions,
                 outofcore::Executor& executor, const std::function<void(const LatticeEdge&, std::size_t)>& visit) {
  executor.run(shape.dims[2], [&](std::size_t z) {
    for (const EdgePlane& plane : set.planes) {
      const auto axis = static_cast<unsigned>(std::countr_zero(static_cast<unsigned>(plane.axes)));
      for (std::uint64_t y = 0; y < shape.dims[1]; ++y) {
        if (plane.used[shape.row(y, z)] == 0) continue;
        const std::size_t begin = shape.rowStart(y, z);
        std::size_t number = plane.prefix[begin];
        for (std::size_t w = 0; w < shape.rowWords(); ++w) {
          for (std::uint64_t rest = plane.bits[begin + w]; rest != 0; rest &= rest - 1, ++number) {
            const std::uint64_t x = w * 64 + static_cast<std::uint64_t>(std::countr_zero(rest));
            LatticeEdge edge{{x, y, z}, frame, plane.axes, 0};
            const double base = axis == 3 ? static_cast<double>(frame)
                                          : static_cast<double>(edge.base[axis]) - static_cast<double>(shape.pad);
            edge.fraction = coordinate(positions[number], axis) - base;
            visit(edge, number);
          }
        }
      }
    }
  });
}

double fieldAt(const GridShape& shape, const FieldFrames& field, const LatticeEdge& edge) {
  const double a = valueAt(shape, field, endOf(shape, edge, false));
  const double b = valueAt(shape, field, endOf(shape, edge, true));
  return a == b ? a : a + edge.fraction * (b - a);  // equal infinities stay
}

Normal4 gradientNormalAt(const GridShape& shape, const FieldFrames& field, std::span<const double> times,
                         std::size_t count, const LatticeEdge& edge) {
  const Normal4 a = gradientAt(shape, field, times, count, endOf(shape, edge, false));
  const Normal4 b = gradientAt(shape, field, times, count, endOf(shape, edge, true));
  Normal4 normal{};
  for (std::size_t c = 0; c < 4; ++c) normal[c] = -(a[c] + edge.fraction * (b[c] - a[c]));
  return normal;
}

}  // namespace tet4d::hypermesh
