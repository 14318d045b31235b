#include "libpreprocess/measure/hypermesh_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libpreprocess/error.h"

namespace tet4d::measure {
namespace {

using Vec4d = std::array<double, 4>;

// The 4D cross product: component i is det(e_i, u, v, w).
Vec4d cross(const Vec4d& u, const Vec4d& v, const Vec4d& w) {
  const auto minor = [&](std::size_t i, std::size_t j, std::size_t k) {
    return u[i] * (v[j] * w[k] - v[k] * w[j]) - u[j] * (v[i] * w[k] - v[k] * w[i]) + u[k] * (v[i] * w[j] - v[j] * w[i]);
  };
  return {minor(1, 2, 3), -minor(0, 2, 3), minor(0, 1, 3), -minor(0, 1, 2)};
}

Vec4d difference(const Vec4d& a, const Vec4d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]}; }

// Flux of (x, y, z, 0) / 3 through a tetrahedron with the vector N: exact, the field is linear.
double flux(const std::array<Vec4d, 4>& p, const Vec4d& normal) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (p[0][c] + p[1][c] + p[2][c] + p[3][c]) / 4 * normal[c];
  return sum / 18;
}

}  // namespace

HypermeshMeter::HypermeshMeter(const Bounds4f& domain, bool closed, const AffineMap& index_to_world,
                               std::span<const double> times)
    : domain_(domain), closed_(closed), index_to_world_(index_to_world), times_(times.begin(), times.end()) {
  const auto middle = [](float low, float high) {
    const double value = (double{low} + double{high}) / 2;
    return std::isfinite(value) ? value : 0;
  };
  centre_ = {middle(domain.min.x, domain.max.x), middle(domain.min.y, domain.max.y),
             middle(domain.min.z, domain.max.z)};
}

bool HypermeshMeter::onSpatialWall(const Vec4f& v) const {
  return v.x == domain_.min.x || v.x == domain_.max.x || v.y == domain_.min.y || v.y == domain_.max.y ||
         v.z == domain_.min.z || v.z == domain_.max.z;
}

void HypermeshMeter::add(std::span<const Vec4f> positions, std::span<const hypermesh::Tet> tets) {
  std::vector<std::array<std::int32_t, 4>> cells;
  for (const hypermesh::Tet& tet : tets) {
    std::array<Vec4d, 4> p;
    std::array<std::int32_t, 4> cell;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec4f& v = positions[tet[i]];
      p[i] = {v.x - centre_[0], v.y - centre_[1], v.z - centre_[2], v.t};
      if (onSpatialWall(v)) closed_ = false;
    }
    const Vec4d normal = cross(difference(p[1], p[0]), difference(p[2], p[0]), difference(p[3], p[0]));
    const double spatial = std::hypot(normal[0], normal[1], normal[2]);
    volume3_.add(std::hypot(spatial, normal[3]) / 6);
    swept_area_.add(spatial / 6);
    for (std::size_t c = 0; c < 3; ++c) spatial_normal_[c].add(normal[c]);
    volume4_.add(flux(p, normal));

    for (std::size_t c = 0; c < 4; ++c) {
      const double centroid = (p[0][c] + p[1][c] + p[2][c] + p[3][c]) / 4 + (c < 3 ? centre_[c] : 0);
      cell[c] = static_cast<std::int32_t>(std::clamp(std::floor(centroid), -2147483648.0, 2147483647.0));
    }
    if (cells.empty() || cells.back() != cell) cells.push_back(cell);

    // Only the spatial parts of N count, and time enters them linearly; the spatial map is one determinant at the end.
    std::array<Vec4d, 4> q = p;
    for (Vec4d& v : q) v[3] = timeOfFrame(times_, v[3]) - times_.front();
    volume4_time_.add(flux(q, cross(difference(q[1], q[0]), difference(q[2], q[0]), difference(q[3], q[0]))));
  }
  std::sort(cells.begin(), cells.end());
  active_cells_ += static_cast<std::uint64_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
  tets_ += tets.size();
}

HypermeshMeasures HypermeshMeter::result() const {
  HypermeshMeasures result;
  result.tets = tets_;
  result.active_cells = active_cells_;
  result.volume3 = volume3_.value();
  result.swept_area = swept_area_.value();
  if (closed_) {
    result.volume4 = volume4_.value();
    result.volume4_world = volume4_time_.value() * std::abs(cellVolume(index_to_world_));
  }
  const double open = std::hypot(spatial_normal_[0].value(), spatial_normal_[1].value(), spatial_normal_[2].value());
  result.closure = result.swept_area > 0 ? open / 6 / result.swept_area : 0;
  return result;
}

HypermeshMeasures measureHypermesh(const hypermesh::File& file, outofcore::Progress& progress) {
  const hypermesh::MeshHeader& header = file.header();
  const bool closed = (header.flags & (hypermesh::kOnGrid | hypermesh::kInnerBoundary)) == hypermesh::kOnGrid;
  HypermeshMeter meter(header.domain, closed, header.index_to_world, file.times());
  progress.phase("measure", file.geometryPages());
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const hypermesh::GatheredPage page = unwrap(file.gather(k));
    meter.add(page.positions, page.view.tets);
    progress.step(k + 1);
  }
  return meter.result();
}

HypermeshMeasures measureHypermesh(std::span<const Vec4f> positions, std::span<const hypermesh::Tet> tets) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  // Times as long as the mesh, so that world time is the frame number.
  float last = 0;
  for (const Vec4f& v : positions) last = std::max(last, v.t);
  std::vector<double> times(static_cast<std::size_t>(std::ceil(last)) + 1);
  for (std::size_t k = 0; k < times.size(); ++k) times[k] = static_cast<double>(k);
  HypermeshMeter meter({{-kFar, -kFar, -kFar, -kFar}, {kFar, kFar, kFar, kFar}}, true, AffineMap{}, times);
  meter.add(positions, tets);
  return meter.result();
}

}  // namespace tet4d::measure
