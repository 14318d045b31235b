#include "libpreprocess/measure/column_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libpreprocess/column_list.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_points.h"
#include "libpreprocess/measure/triangle_tree.h"

namespace tet4d::measure {
namespace {

// Of the foot of p on the triangle; outside it those of the nearest corner's side, by clamping: a sample lies close.
std::array<double, 3> barycentric(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  Point3 u, v, w;
  for (std::size_t i = 0; i < 3; ++i) u[i] = b[i] - a[i], v[i] = c[i] - a[i], w[i] = p[i] - a[i];
  const auto dot = [](const Point3& x, const Point3& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-14 * uu * vv)) {  // a needle: along its longer side
    const bool is_u = uu >= vv;
    const double length = std::max(uu, vv), share = length > 0 ? std::clamp((is_u ? wu : wv) / length, 0.0, 1.0) : 0;
    return is_u ? std::array{1 - share, share, 0.0} : std::array{1 - share, 0.0, share};
  }
  const double s = std::max(0.0, (wu * vv - wv * uv) / det), t = std::max(0.0, (wv * uu - wu * uv) / det);
  const double sum = std::max(1.0, s + t);
  return {1 - (s + t) / sum, s / sum, t / sum};
}

class Comparer {
 public:
  Comparer(const exchange::Slice& from, std::vector<Point3> from_points, const exchange::Slice& to,
           std::vector<Point3> to_points)
      : from_(from), to_(to), from_points_(std::move(from_points)), to_points_(std::move(to_points)) {}

  void run(std::vector<ColumnDistance>& distances, std::vector<double>& squares) const {
    if (from_.mesh.triangles.empty() || to_.mesh.triangles.empty()) return;
    // Each triangle is found again by its place in the mesh: the tree hands out a rank of its own.
    const TriangleTree tree({to_points_, to_.mesh.triangles});
    std::uint32_t hint = 0;
    for (std::size_t v = 0; v < from_points_.size(); ++v) {
      const TriangleTree::Nearest nearest = tree.nearest(from_points_[v], hint);
      hint = nearest.triangle;
      const auto& triangle = to_.mesh.triangles[tree.original(nearest.triangle)];
      const auto weights =
          barycentric(from_points_[v], to_points_[triangle[0]], to_points_[triangle[1]], to_points_[triangle[2]]);
      for (std::size_t c = 0; c < distances.size(); ++c) compare(v, triangle, weights, c, distances[c], squares[c]);
    }
  }

 private:
  void compare(std::size_t v, const Triangle& triangle, const std::array<double, 3>& weights, std::size_t c,
               ColumnDistance& distance, double& squares) const {
    const std::size_t n = from_.columns[c].components;
    double squared = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double value = 0;
      for (std::size_t k = 0; k < 3; ++k)
        value += weights[k] == 0 ? 0 : weights[k] * double{to_.columns[c].values[triangle[k] * n + i]};
      const double difference = value - double{from_.columns[c].values[v * n + i]};
      squared += difference * difference;
    }
    if (!std::isfinite(squared)) {
      ++distance.unknown;
      return;
    }
    ++distance.samples;
    squares += squared;
    distance.max = std::max(distance.max, std::sqrt(squared));
  }

  const exchange::Slice &from_, &to_;
  std::vector<Point3> from_points_, to_points_;
};

}  // namespace

std::vector<ColumnDistance> compareColumns(const hypermesh::File& mesh, const hypermesh::File& reference,
                                           const std::vector<double>& frames, outofcore::Progress& progress) {
  exchange::SliceWants wants, wants_reference;
  std::vector<ColumnDistance> distances;
  for (std::size_t c = 0; c < mesh.columns().size(); ++c) {
    const auto other = findColumn(reference.columns(), columnName(mesh.columns()[c]));
    if (!other || reference.columns()[*other].components != mesh.columns()[c].components) continue;
    wants.columns.push_back(c);
    wants_reference.columns.push_back(*other);
    distances.push_back({columnName(mesh.columns()[c]), 0, 0, 0, 0});
  }
  if (distances.empty()) return distances;
  std::vector<double> squares(distances.size());
  const AffineMap& map = reference.header().index_to_world;
  progress.phase("measure columns", frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const exchange::Slice a = exchange::sliceHypermesh(mesh, frames[i], wants);
    const exchange::Slice b = exchange::sliceHypermesh(reference, frames[i], wants_reference);
    const std::vector<Point3> points_a = slicePoints(a.mesh, map, reference.header().domain);
    const std::vector<Point3> points_b = slicePoints(b.mesh, map, reference.header().domain);
    Comparer(a, points_a, b, points_b).run(distances, squares);
    Comparer(b, points_b, a, points_a).run(distances, squares);
    progress.step(i + 1);
  }
  for (std::size_t c = 0; c < distances.size(); ++c)
    if (distances[c].samples > 0) distances[c].rms = std::sqrt(squares[c] / static_cast<double>(distances[c].samples));
  return distances;
}

}  // namespace tet4d::measure
