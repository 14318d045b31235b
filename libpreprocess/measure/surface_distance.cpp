#include "libpreprocess/measure/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/measure/compensated_sum.h"

namespace tet4d::measure {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Tasks of this many triangles: their borders, and so every sum, do not depend on the threads.
constexpr std::size_t kBlock = 512;

using Corners = std::array<Point3, 3>;

// What is asked of the other side.
struct Target {
  // Distance of a point; the hint is the caller's own, kept from point to point.
  std::function<double(const Point3&, std::uint32_t&)> distance;
  // Largest distance of a triangle's points, bounded from above: any bound is right, `limit` says from where on none
  // helps.
  std::function<double(const Corners&, double limit)> bound;
};

Point3 between(const Point3& a, const Point3& b) { return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}; }
double length(const Point3& a, const Point3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

double areaOf(const Corners& t) {
  const Point3 u{t[1][0] - t[0][0], t[1][1] - t[0][1], t[1][2] - t[0][2]};
  const Point3 v{t[2][0] - t[0][0], t[2][1] - t[0][1], t[2][2] - t[0][2]};
  return std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
}

Corners cornersOf(const SurfaceView& mesh, std::size_t i) {
  const Triangle& t = mesh.triangles[i];
  return {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
}

double longestEdge(const Corners& t) { return std::max({length(t[0], t[1]), length(t[1], t[2]), length(t[2], t[0])}); }

std::size_t blocksOf(std::size_t count) { return (count + kBlock - 1) / kBlock; }

// ---- the distribution: centroids of k x k equal pieces of each triangle, k by its area
struct Sample {
  double distance, weight;
};

struct Samples {
  std::vector<Sample> all;
  double spacing = 0;
};

Samples sampleSurface(const SurfaceView& mesh, const Target& target, std::uint64_t wanted,
                      outofcore::Executor& executor) {
  const std::size_t triangles = mesh.triangles.size();
  std::vector<double> areas(triangles);
  CompensatedSum sum;
  for (std::size_t i = 0; i < triangles; ++i) areas[i] = areaOf(cornersOf(mesh, i)), sum.add(areas[i]);
  const double total = sum.value();
  const double share = static_cast<double>(std::max<std::uint64_t>(wanted, 1));
  // Without any area, every triangle counts the same.
  const auto sideOf = [&](std::size_t i) {
    return total > 0 ? std::max(1.0, std::floor(std::sqrt(share * (areas[i] / total)))) : 1.0;
  };
  std::vector<Samples> parts(blocksOf(triangles));
  executor.run(parts.size(), [&](std::size_t block) {
    Samples& part = parts[block];
    std::uint32_t hint = 0;
    for (std::size_t i = block * kBlock; i < std::min(triangles, (block + 1) * kBlock); ++i) {
      const Corners t = cornersOf(mesh, i);
      const double side = sideOf(i), weight = (total > 0 ? areas[i] : 1.0) / (side * side);
      // Piece (r, s) of the lattice of the triangle, upright or turned over; its centroid in thirds of a step.
      const auto take = [&](double r, double s) {
        Point3 p;
        for (std::size_t c = 0; c < 3; ++c)
          p[c] = t[0][c] + (r / side) * (t[1][c] - t[0][c]) + (s / side) * (t[2][c] - t[0][c]);
        part.all.push_back({target.distance(p, hint), weight});
      };
      for (double r = 0; r < side; ++r) {
        for (double s = 0; r + s < side; ++s) {
          take(r + 1.0 / 3, s + 1.0 / 3);
          if (r + s + 1 < side) take(r + 2.0 / 3, s + 2.0 / 3);
        }
      }
      // From the centroid of a triangle to its farthest corner it is at most two thirds of a median.
      part.spacing = std::max(part.spacing, longestEdge(t) * (2.0 / 3) / side);
    }
  });
  Samples samples;
  for (Samples& part : parts) {
    samples.all.insert(samples.all.end(), part.all.begin(), part.all.end());
    samples.spacing = std::max(samples.spacing, part.spacing);
  }
  return samples;
}

void describe(Samples& samples, OneWayDistance& result) {
  CompensatedSum weights, first, second;
  for (const Sample& s : samples.all) {
    weights.add(s.weight);
    first.add(s.weight * s.distance);
    second.add(s.weight * s.distance * s.distance);
    result.max = std::max(result.max, s.distance);
  }
  result.samples = samples.all.size();
  result.sample_spacing = samples.spacing;
  result.mean = first.value() / weights.value();
  result.rms = std::sqrt(second.value() / weights.value());
  std::sort(samples.all.begin(), samples.all.end(), [](const Sample& a, const Sample& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.weight < b.weight;
  });
  CompensatedSum below;
  for (const Sample& s : samples.all) {
    below.add(s.weight);
    result.p99 = s.distance;
    if (below.value() >= 0.99 * weights.value()) break;
  }
}

// ---- the maximum: pieces of triangles, halved until none can be farther than what was found by more than the
// tolerance
struct Piece {
  Corners corners;
  std::array<double, 3> distances;  // of the corners
  double bound = kInfinity;
};

// Of the points of a triangle none is farther from all corners than the longest edge / sqrt(3) (an equilateral one's).
double reachOf(const Piece& piece) { return longestEdge(piece.corners) / std::sqrt(3.0); }
double farthestOf(const Piece& piece) { return std::max({piece.distances[0], piece.distances[1], piece.distances[2]}); }

void boundPiece(Piece& piece, const Target& target, double enough) {
  piece.bound = std::min(piece.bound, farthestOf(piece) + reachOf(piece));
  if (piece.bound > enough) piece.bound = std::min(piece.bound, target.bound(piece.corners, piece.bound));
}

// The halves along the longest edge: needles become round before they become small.
std::array<Piece, 2> halves(const Piece& piece, const Target& target, double enough, std::uint32_t& hint) {
  std::size_t edge = 0;
  for (std::size_t c = 1; c < 3; ++c) {
    const auto longer = [&](std::size_t k) { return length(piece.corners[k], piece.corners[(k + 1) % 3]); };
    if (longer(c) > longer(edge)) edge = c;
  }
  const std::size_t next = (edge + 1) % 3;
  const Point3 middle = between(piece.corners[edge], piece.corners[next]);
  const double distance = target.distance(middle, hint);
  std::array<Piece, 2> made{piece, piece};
  made[0].corners[next] = middle, made[0].distances[next] = distance;
  made[1].corners[edge] = middle, made[1].distances[edge] = distance;
  for (Piece& half : made) boundPiece(half, target, enough);
  return made;
}

// Keeps the pieces that may be farther than `enough`.
std::vector<Piece> gather(std::vector<std::vector<Piece>>& parts, double enough) {
  std::vector<Piece> kept;
  for (const std::vector<Piece>& part : parts) {
    for (const Piece& piece : part) {
      if (piece.bound > enough) kept.push_back(piece);
    }
  }
  return kept;
}

void searchMaximum(const SurfaceView& mesh, const Target& target, double tolerance, std::uint64_t max_pieces,
                   outofcore::Executor& executor, OneWayDistance& result) {
  const std::size_t triangles = mesh.triangles.size();
  // Every piece dropped has a bound of at most the maximum at that time + tolerance.
  double enough = result.max + tolerance;
  std::vector<std::vector<Piece>> parts(blocksOf(triangles));
  executor.run(parts.size(), [&](std::size_t block) {
    std::uint32_t hint = 0;
    for (std::size_t i = block * kBlock; i < std::min(triangles, (block + 1) * kBlock); ++i) {
      Piece piece{cornersOf(mesh, i), {}};
      for (std::size_t c = 0; c < 3; ++c) piece.distances[c] = target.distance(piece.corners[c], hint);
      boundPiece(piece, target, std::max(enough, farthestOf(piece) + tolerance));
      // The farthest corner is kept even if the piece is done: it may be the maximum.
      if (farthestOf(piece) > result.max || piece.bound > enough) parts[block].push_back(piece);
    }
  });
  const auto raise = [&] {
    for (const auto& part : parts) {
      for (const Piece& piece : part) result.max = std::max(result.max, farthestOf(piece));
    }
    enough = result.max + tolerance;
  };
  raise();
  std::vector<Piece> open = gather(parts, enough);
  result.pieces = triangles;
  while (!open.empty() && result.pieces + 2 * open.size() <= max_pieces) {
    parts.assign(blocksOf(open.size()), {});
    executor.run(parts.size(), [&](std::size_t block) {
      std::uint32_t hint = 0;
      for (std::size_t i = block * kBlock; i < std::min(open.size(), (block + 1) * kBlock); ++i) {
        for (const Piece& half : halves(open[i], target, enough, hint)) parts[block].push_back(half);
      }
    });
    result.pieces += 2 * open.size();
    raise();
    open = gather(parts, enough);
  }
  result.max_bound = enough;
  for (const Piece& piece : open) result.max_bound = std::max(result.max_bound, piece.bound);
}

OneWayDistance measureOneWay(const SurfaceView& mesh, const Target& target, double tolerance,
                             const DistanceOptions& options, outofcore::Executor& executor) {
  OneWayDistance result;
  Samples samples = sampleSurface(mesh, target, options.samples, executor);
  describe(samples, result);
  searchMaximum(mesh, target, tolerance, options.max_pieces, executor, result);
  return result;
}

OneWayDistance infinitelyFar() {
  OneWayDistance far;
  far.max = far.max_bound = far.p99 = far.rms = far.mean = kInfinity;
  return far;
}

// ---- coordinates: from the middle, scaled by a power of two to about 1
struct Box {
  Point3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
};

void enclose(const SurfaceView& mesh, const char* name, Box& box) {
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = mesh.points[v][c];
        if (!std::isfinite(x)) {
          throw Error(FaultCode::kBadInput, name, "point " + std::to_string(v), "a coordinate is not finite",
                      "give meshes whose points are numbers");
        }
        box.low[c] = std::min(box.low[c], x);
        box.high[c] = std::max(box.high[c], x);
      }
    }
  }
}

struct Frame {
  Point3 middle{};
  int exponent = 0;     // one unit here is 2^exponent of the world
  double diagonal = 0;  // of the box, here
};

Frame frameOf(const Box& box) {
  Frame frame;
  double extent = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    frame.middle[c] = box.low[c] / 2 + box.high[c] / 2;
    extent = std::max(extent, box.high[c] / 2 - box.low[c] / 2);
  }
  frame.exponent = extent > 0 ? std::ilogb(extent) : 0;
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double side = std::scalbn(box.high[c] / 2 - box.low[c] / 2, -frame.exponent) * 2;
    sum += side * side;
  }
  frame.diagonal = std::sqrt(sum);
  return frame;
}

std::vector<Point3> moved(std::span<const Point3> points, const Frame& frame) {
  std::vector<Point3> result(points.begin(), points.end());
  for (Point3& p : result) {
    for (std::size_t c = 0; c < 3; ++c)
      p[c] = std::scalbn(p[c], -frame.exponent) - std::scalbn(frame.middle[c], -frame.exponent);
  }
  return result;
}

double toleranceIn(const Frame& frame, double world) {
  return world > 0 ? std::scalbn(world, -frame.exponent) : 1e-4 * frame.diagonal;
}

void toWorldUnits(OneWayDistance& distance, int exponent) {
  for (double* value :
       {&distance.max, &distance.max_bound, &distance.p99, &distance.rms, &distance.mean, &distance.sample_spacing}) {
    *value = std::scalbn(*value, exponent);
  }
}

}  // namespace

double SurfaceDistance::max() const { return std::max(forward.max, backward.max); }
double SurfaceDistance::maxBound() const { return std::max(forward.max_bound, backward.max_bound); }
double SurfaceDistance::p99() const { return std::max(forward.p99, backward.p99); }
double SurfaceDistance::rms() const { return std::max(forward.rms, backward.rms); }
double SurfaceDistance::mean() const { return std::max(forward.mean, backward.mean); }

SurfaceDistance surfaceDistance(const SurfaceView& a, const SurfaceView& b, const DistanceOptions& options,
                                outofcore::Executor& executor) {
  Box box;
  enclose(a, "A", box);
  enclose(b, "B", box);
  SurfaceDistance result;
  if (a.triangles.empty() || b.triangles.empty()) {
    if (!a.triangles.empty()) result.forward = infinitelyFar();
    if (!b.triangles.empty()) result.backward = infinitelyFar();
    return result;
  }
  const Frame frame = frameOf(box);
  const std::vector<Point3> points_a = moved(a.points, frame), points_b = moved(b.points, frame);
  const auto oneWay = [&](const SurfaceView& from, const SurfaceView& to) {
    const TriangleTree tree(to);
    const Target target{[&](const Point3& p, std::uint32_t& hint) {
                          const TriangleTree::Nearest nearest = tree.nearest(p, hint);
                          hint = nearest.triangle;
                          return std::sqrt(nearest.squared);
                        },
                        [&](const Corners& corners, double limit) {
                          return std::sqrt(tree.covering(std::span<const Point3, 3>(corners), limit * limit));
                        }};
    OneWayDistance distance = measureOneWay(from, target, toleranceIn(frame, options.tolerance), options, executor);
    toWorldUnits(distance, frame.exponent);
    return distance;
  };
  const SurfaceView moved_a{points_a, a.triangles}, moved_b{points_b, b.triangles};
  result.forward = oneWay(moved_a, moved_b);
  result.backward = oneWay(moved_b, moved_a);
  return result;
}

OneWayDistance distanceToSphere(const SurfaceView& a, const Point3& centre, double radius,
                                const DistanceOptions& options, outofcore::Executor& executor) {
  Box box;
  enclose(a, "A", box);
  if (a.triangles.empty()) return {};
  for (std::size_t c = 0; c < 3; ++c) {
    box.low[c] = std::min(box.low[c], centre[c] - radius);
    box.high[c] = std::max(box.high[c], centre[c] + radius);
  }
  const Frame frame = frameOf(box);
  const std::vector<Point3> points = moved(a.points, frame);
  const Point3 middle = moved(std::span(&centre, 1), frame).front();
  const double reach = std::scalbn(radius, -frame.exponent);
  const Target target{[&](const Point3& p, std::uint32_t&) { return std::abs(length(p, middle) - reach); },
                      [&](const Corners& t, double) {
                        const double out = std::max({length(t[0], middle), length(t[1], middle), length(t[2], middle)});
                        const double in = std::sqrt(squaredDistance(middle, t[0], t[1], t[2]));
                        return std::max(out - reach, reach - in);
                      }};
  OneWayDistance distance =
      measureOneWay({points, a.triangles}, target, toleranceIn(frame, options.tolerance), options, executor);
  toWorldUnits(distance, frame.exponent);
  return distance;
}

}  // namespace tet4d::measure
