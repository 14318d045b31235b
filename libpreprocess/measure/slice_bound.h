// Whether the slices of two hypermeshes stay within a distance: a proven bound at each of many times.
#pragma once

#include <functional>
#include <vector>

#include "formats/core/slicer.h"
#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::measure {

using SliceAt = std::function<SliceMesh(double frame)>;

struct SliceBound {
  // World units: no point of either slice is farther from the other slice, at any time measured. Where `within` is
  // false, what was found at `frame`, and the times left were not measured. Infinite where one slice is empty and the
  // other is not.
  double bound = 0;
  double frame = 0;  // where it is largest
  bool within = true;
};

// Every frame's time of the domain, its ends, and one time between each two frames, off the middle: 0.37 or 0.71 after
// the former in turn.
std::vector<double> framesAndBetween(const hypermesh::File& reference);

// Bounds the symmetric Hausdorff distance of slices of `mesh` and `reference` at each of `frames` (phase "confirm") and
// stops at the first time where it may exceed `limit`, which is then moved to the front of `frames`. The bounds are
// those of surfaceDistance(), proven for the float32 slices that every reader makes, at most limit / 50 above the
// distance itself. Nothing is said of other times: between them slices move linearly within tetrahedra, yet a component
// that is born a little earlier or later is at its full distance at once. The same for any number of threads.
SliceBound boundSlices(const SliceAt& mesh, const SliceAt& reference, const AffineMap& map, const Bounds4f& domain,
                       std::vector<double>& frames, double limit, outofcore::Executor& executor,
                       outofcore::Progress& progress);

}  // namespace tet4d::measure
