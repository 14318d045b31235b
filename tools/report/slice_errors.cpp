#include "tools/report/slice_errors.h"

#include <algorithm>
#include <cmath>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_measures.h"

namespace tet4d::report {

void SliceErrors::add(double max, double bound, double p99, double rms) {
  max_ = std::max(max_, max);
  bound_ = std::max(bound_, bound);
  p99_ = std::max(p99_, p99);
  squares_ += rms * rms;
  ++slices_;
}

void SliceErrors::addSize(double area_error, double volume_error) {
  area_ = std::max(area_, std::abs(area_error));
  volume_ = std::max(volume_, std::abs(volume_error));
}

double SliceErrors::rms() const { return slices_ == 0 ? 0 : std::sqrt(squares_ / static_cast<double>(slices_)); }

void SliceErrors::writeLengths(Row& row, const std::string& kind, double cell) const {
  const auto lengths = [&](const std::string& suffix, double unit) {
    row["rms_" + kind + suffix] = number(rms() / unit);
    row["p99_" + kind + suffix] = number(p99_ / unit);
    row["max_" + kind + suffix] = number(max_ / unit);
    row["max_bound_" + kind + suffix] = number(bound_ / unit);
  };
  lengths("_cells", cell);
  lengths("", 1);
}

void SliceErrors::write(Row& row, const std::string& kind, double cell) const {
  writeLengths(row, kind, cell);
  row["area_error_" + kind] = number(area_);
  row["volume_error_" + kind] = number(volume_);
}

exchange::WorldMesh sliceAt(const hypermesh::File& mesh, double time) {
  const double frame = frameOfTime(mesh.times(), time);
  return exchange::worldMesh(exchange::sliceHypermesh(mesh, frame), mesh.header().index_to_world, false);
}

Size sizeOf(const exchange::WorldMesh& mesh) {
  if (mesh.points.empty()) return {};
  // From the first point, so that float32 keeps what the slice had.
  std::vector<Vec3f> points;
  for (const auto& p : mesh.points) {
    points.push_back({static_cast<float>(p[0] - mesh.points[0][0]), static_cast<float>(p[1] - mesh.points[0][1]),
                      static_cast<float>(p[2] - mesh.points[0][2])});
  }
  const measure::SliceMeasures size = measure::measureSlice(points, mesh.triangles);
  return {size.area, size.volume, size.bounds()};
}

}  // namespace tet4d::report
