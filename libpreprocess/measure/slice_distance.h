// How far the slices of two hypermeshes are from each other: at frames and between them.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/measure/surface_distance.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::measure {

// Of one time. World units; infinite where one slice is empty and the other is not.
struct SliceDifference {
  double frame = 0;
  double rms = 0, p99 = 0, max = 0;         // symmetric: the worse of both ways
  double volume = 0, volume_reference = 0;  // enclosed, where the slices are closed
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

}  // namespace tet4d::measure
