// How far two triangle meshes are from each other: the largest distance with a proven bound, and the distribution.
//
// One way, from A to B, is d(x, B) over the points x of A; the distance of the two is the worse of both ways (max is
// the Hausdorff distance). Coordinates are taken from the middle of both meshes and scaled by a power of two, so a far
// origin, or meshes of 1e-150 or 1e150, lose nothing.
#pragma once

#include <cstdint>

#include "libpreprocess/measure/triangle_tree.h"
#include "libpreprocess/outofcore/executor.h"

namespace tet4d::measure {

struct DistanceOptions {
  // How far apart `max` and `max_bound` may be, world units; 0: 1e-4 of the diagonal of both meshes' box.
  double tolerance = 0;
  // Of the distribution, spread evenly over the area; every triangle has one at least.
  std::uint64_t samples = 200'000;
  // Pieces the search for the maximum may make; where they do not suffice, max_bound says what is proven.
  std::uint64_t max_pieces = 4'000'000;
};

// World units. Not a number is never among them; infinite where one mesh is empty and the other is not.
struct OneWayDistance {
  double max = 0;        // the largest found, attained by a point
  double max_bound = 0;  // no point is farther; at most `tolerance` more than max unless max_pieces ended the search
  double p99 = 0;        // 99 % of the area is nearer
  double rms = 0, mean = 0;  // over the area
  // No point of the area is farther from its sample: mean is exact to that, p99 too.
  double sample_spacing = 0;
  std::uint64_t samples = 0, pieces = 0;
};

struct SurfaceDistance {
  OneWayDistance forward, backward;  // A to B, B to A
  double max() const;
  double maxBound() const;
  double p99() const;
  double rms() const;
  double mean() const;  // each the larger of the two ways
};

// Throws Error kBadInput naming the mesh ("A") and its point if a coordinate is not finite. The same numbers for any
// number of threads. O((samples + pieces) log triangles); memory of both trees, 16 bytes a sample, 200 a piece.
SurfaceDistance surfaceDistance(const SurfaceView& a, const SurfaceView& b, const DistanceOptions& options,
                                outofcore::Executor& executor);

// The same one way, to the sphere |x - centre| = radius: a closed form to judge by. The bound of a piece is exact, as
// |x - centre| is convex. An empty mesh is at 0.
OneWayDistance distanceToSphere(const SurfaceView& a, const Point3& centre, double radius,
                                const DistanceOptions& options, outofcore::Executor& executor);

}  // namespace tet4d::measure
