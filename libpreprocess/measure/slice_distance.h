// How far the slices of two hypermeshes are from each other: at frames and between them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/core/slicer.h"
#include "formats/hypermesh.h"
#include "libpreprocess/measure/surface_distance.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::measure {

// Of one time. World units; infinite where one slice is empty and the other is not.
struct SliceDifference {
  double frame = 0;
  double rms = 0, p99 = 0, max = 0;         // symmetric: the worse of both ways
  double volume = 0, volume_reference = 0;  // enclosed, where both slices bound one (SliceMeasures::bounds)
  std::uint64_t triangles = 0, triangles_reference = 0;
};

// Over all times: rms the mean, p99 and max the largest.
struct SliceDistance {
  std::vector<SliceDifference> slices;
  double rms = 0, p99 = 0, max = 0;
  double volume_error = 0;  // largest |volume - reference|, over the largest reference
};

// `count` times over the domain's, none at its ends: frames and times between them in turn. Fewer if there are fewer.
std::vector<double> sampleFrames(const hypermesh::File& reference, std::size_t count);

// Compares slices of `mesh` with those of `reference` at the frames given (phase "measure"). Both have the same map and
// times. The same numbers for any number of threads. O(slices log slices); memory of two slices and their trees.
SliceDistance compareSlices(const hypermesh::File& mesh, const hypermesh::File& reference,
                            const std::vector<double>& frames, const DistanceOptions& options,
                            outofcore::Executor& executor, outofcore::Progress& progress);

// Times to measure apart, in frames: the errors at frames and between them have different causes.
struct SliceTimes {
  std::vector<double> at, between;
};
// At most `count` of either, spread over the domain's inner times: whole frames, and times 0.37 after a frame. A domain
// of one interval has none at frames.
SliceTimes sampleTimes(const Bounds4f& domain, std::size_t count);

// A slice by its frame number, in index space.
using SliceSource = std::function<SliceMesh(double frame)>;
SliceSource slicesOf(const hypermesh::File& mesh);
// … of tetrahedra in memory, which another program made; last_t: as of TetSlicer. Both must outlive the result.
SliceSource slicesOf(std::span<const Vec4f> positions, std::span<const hypermesh::Tet> tets, float last_t);

// Lengths as `map` has them, from `corner` (index space): {} of both measures in cells.
struct SliceFrame {
  AffineMap map;
  std::array<double, 3> corner{};
};
// Compares slices from anywhere. Volumes are compared where both slices bound one: volume_error is 0 if none do, and
// SliceDifference::volume_reference tells which did.
SliceDistance compareSlices(const SliceSource& mesh, const SliceSource& reference, const SliceFrame& where,
                            const std::vector<double>& frames, const DistanceOptions& options,
                            outofcore::Executor& executor, outofcore::Progress& progress);

struct SplitDistance {
  SliceDistance at, between;
};
// compareSlices() at both kinds of times, each reference slice made once for all meshes compared.
class SliceJudge {
 public:
  SliceJudge(const SliceSource& reference, SliceTimes times, SliceFrame where, DistanceOptions options);
  SplitDistance judge(const SliceSource& mesh, outofcore::Executor& executor, outofcore::Progress& progress);

 private:
  SliceSource reference_;
  SliceTimes times_;
  SliceFrame where_;
  DistanceOptions options_;
};

}  // namespace tet4d::measure
