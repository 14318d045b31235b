#include "libpreprocess/exchange/slice_columns.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace tet4d::exchange {
namespace {

using Vec3d = std::array<double, 3>;

Vec3d cross(const Vec3d& u, const Vec3d& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

double dot(const Vec3d& u, const Vec3d& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

template <class Point>
Vec3d between(const Point& from, const Point& to) {
  return {double{to.x} - from.x, double{to.y} - from.y, double{to.z} - from.z};
}

// Numbers beyond float32 become its largest.
float clamped(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}

void makeUnit(std::span<float> v) {
  const double length = std::hypot(double{v[0]}, double{v[1]}, double{v[2]});
  if (!(length > 0)) return;
  for (float& x : v) x = static_cast<float>(x / length);
}

// World time that frame `t` lasts.
double stepAt(std::span<const double> times, float t) {
  if (times.size() < 2) return 1;
  const double last = static_cast<double>(times.size() - 2);
  const auto k = static_cast<std::size_t>(std::clamp(std::floor(double{t}), 0.0, last));
  return times[k + 1] - times[k];
}

}  // namespace

void interpolateColumn(std::span<const float> values, std::span<const Vec4f> positions,
                       std::span<const std::array<std::uint32_t, 2>> ends, float t, MeshColumn& column) {
  const std::size_t n = column.components;
  const bool is_normal = n == 3 && column.name == kNormal;
  std::size_t at = column.values.size();
  column.values.resize(at + ends.size() * n);
  for (const auto& [a, b] : ends) {
    const float begin = positions[a].t, end = positions[b].t;
    const double lambda = a == b ? 0 : double{(t - begin) / (end - begin)};
    const std::span out(column.values.data() + at, n);
    for (std::size_t c = 0; c < n; ++c) {
      const float from = values[a * n + c], to = values[b * n + c];
      // Where both ends agree nothing is computed: an infinity stays one.
      out[c] = from == to ? from : static_cast<float>(from + lambda * (double{to} - from));
    }
    if (is_normal) makeUnit(out);
    at += n;
  }
}

TetVelocity::TetVelocity(const AffineMap& map, std::span<const double> times, float t)
    : axes_(map.axes), time_of_frame_(stepAt(times, t)) {}

Vec3d TetVelocity::worldEdge(const Vec3d& index) const {
  Vec3d world{0, 0, 0};
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t axis = 0; axis < 3; ++axis) world[c] += index[axis] * axes_[axis][c];
  }
  return world;
}

// In world units a frame. n_s = sum of dt_i (e_j x e_k), n_t = -det(e_1, e_2, e_3), up to a common factor that cancels.
Vec3d TetVelocity::ofTet(const hypermesh::Tet& tet, std::span<const Vec4f> positions) const {
  const Vec4f& first = positions[tet[0]];
  std::array<Vec3d, 3> e;
  Vec3d dt{};
  for (std::size_t i = 0; i < 3; ++i) {
    e[i] = worldEdge(between(first, positions[tet[i + 1]]));
    dt[i] = double{positions[tet[i + 1]].t} - first.t;
  }
  Vec3d normal{0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d side = cross(e[(i + 1) % 3], e[(i + 2) % 3]);
    for (std::size_t c = 0; c < 3; ++c) normal[c] += dt[i] * side[c];
  }
  const double det = dot(e[0], cross(e[1], e[2])), length = std::hypot(normal[0], normal[1], normal[2]);
  if (!(length > 0)) return {0, 0, 0};
  const double speed = det / length;
  return {speed * (normal[0] / length), speed * (normal[1] / length), speed * (normal[2] / length)};
}

void TetVelocity::add(const TetSlicer& slicer, std::span<const hypermesh::Tet> tets, std::span<const Vec4f> positions) {
  const SliceMesh& mesh = slicer.mesh();
  sums_.resize(mesh.positions.size(), {0, 0, 0, 0});
  for (; triangles_ < mesh.triangles.size(); ++triangles_) {
    const auto& [p, q, r] = mesh.triangles[triangles_];
    const Vec3d u = worldEdge(between(mesh.positions[p], mesh.positions[q]));
    const Vec3d w = worldEdge(between(mesh.positions[p], mesh.positions[r]));
    const Vec3d side = cross(u, w);
    const double area = std::hypot(side[0], side[1], side[2]);
    if (!(area > 0)) continue;
    const Vec3d velocity = ofTet(tets[slicer.tets()[triangles_]], positions);
    for (const std::uint32_t corner : {p, q, r}) {
      for (std::size_t c = 0; c < 3; ++c) sums_[corner][c] += area * velocity[c];
      sums_[corner][3] += area;
    }
  }
}

MeshColumn TetVelocity::column(std::size_t vertices) const {
  MeshColumn column{kVelocity, 3, std::vector<float>(3 * vertices, 0.0f)};
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const double area = sums_[i][3];
    if (!(area > 0)) continue;
    for (std::size_t c = 0; c < 3; ++c) column.values[3 * i + c] = clamped(sums_[i][c] / area / time_of_frame_);
  }
  return column;
}

}  // namespace tet4d::exchange
