#include "libpreprocess/measure/slice_bound.h"

#include <algorithm>
#include <cmath>

#include "libpreprocess/measure/slice_points.h"
#include "libpreprocess/measure/surface_distance.h"

namespace tet4d::measure {
namespace {

constexpr double kTolerance = 0.02;  // of the limit

}  // namespace

std::vector<double> framesAndBetween(const hypermesh::File& reference) {
  const double first = reference.header().domain.min.t, last = reference.header().domain.max.t;
  std::vector<double> frames{first};
  const auto add = [&](double frame) {
    if (frame > frames.back() && frame < last) frames.push_back(frame);
  };
  bool is_odd = false;
  for (double k = std::floor(first); k < last; ++k) {
    add(k);
    add(k + (is_odd ? 0.71 : 0.37));
    is_odd = !is_odd;
  }
  if (last > first) frames.push_back(last);
  return frames;
}

SliceBound boundSlices(const SliceAt& mesh, const SliceAt& reference, const AffineMap& map, const Bounds4f& domain,
                       std::vector<double>& frames, double limit, outofcore::Executor& executor,
                       outofcore::Progress& progress) {
  DistanceOptions options;
  options.tolerance = kTolerance * limit;
  options.samples = 1;  // one a triangle: the distribution is not asked for
  progress.phase("confirm", frames.size());
  SliceBound result;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double frame = frames[i];
    const SliceMesh a = mesh(frame), b = reference(frame);
    const std::vector<Point3> points_a = slicePoints(a, map, domain), points_b = slicePoints(b, map, domain);
    const SurfaceDistance distance =
        surfaceDistance({points_a, a.triangles}, {points_b, b.triangles}, options, executor);
    if (distance.maxBound() > result.bound) result.bound = distance.maxBound(), result.frame = frame;
    if (!(distance.maxBound() <= limit)) {
      result.within = false;
      std::rotate(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(i),
                  frames.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      break;
    }
    progress.step(i + 1);
  }
  return result;
}

}  // namespace tet4d::measure
