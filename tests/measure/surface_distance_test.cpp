#include "libpreprocess/measure/surface_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "libpreprocess/error.h"
#include "tests/measure/triangle_meshes.h"

namespace tet4d::measure {
namespace {

using testing::Surface;

SurfaceDistance distanceOf(const Surface& a, const Surface& b, const DistanceOptions& options = {},
                           std::size_t threads = 2) {
  outofcore::ThreadExecutor executor(threads);
  return surfaceDistance(a.view(), b.view(), options, executor);
}

// The distance of a point to a triangle by a search that knows no regions: golden sections within golden sections, over
// the convex function of two parameters.
double slowDistance(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  const auto at = [&](double s, double t) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = a[k] + s * ((1 - t) * b[k] + t * c[k] - a[k]) - p[k];
      sum += x * x;
    }
    return sum;
  };
  const auto least = [](const auto& f) {
    double low = 0, high = 1;
    for (int i = 0; i < 90; ++i) {
      const double x = low + (high - low) * 0.382, y = low + (high - low) * 0.618;
      (f(x) < f(y) ? high : low) = f(x) < f(y) ? y : x;
    }
    return std::min({f(low), f(0.0), f(1.0)});
  };
  return std::sqrt(least([&](double s) { return least([&](double t) { return at(s, t); }); }));
}

TEST(TriangleDistance, IsThatOfASlowSearch) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Point3{unit(random), unit(random), unit(random)}; };
  for (int i = 0; i < 150; ++i) {
    const Point3 a = point(), b = point(), c = i % 5 == 0 ? b : point(), p = point();
    EXPECT_NEAR(std::sqrt(squaredDistance(p, a, b, c)), slowDistance(p, a, b, c), 2e-7) << i;
  }
}

TEST(TriangleDistanceStiff, NeedlesSegmentsAndPoints) {
  const Point3 p{0.5, 3, 4};
  EXPECT_DOUBLE_EQ(squaredDistance(p, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}), 25);
  EXPECT_DOUBLE_EQ(squaredDistance(p, {0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0, 0}), 25);
  for (const double width : {1e-6, 1e-12, 1e-16, 1e-30, 1e-200, 1e-310}) {
    EXPECT_NEAR(squaredDistance(p, {0, 0, 0}, {1, 0, 0}, {0.5, width, 0}), 25, 1e-5) << width;
    EXPECT_NEAR(squaredDistance({0.5, 0, 4}, {0, -width, 0}, {1, -width, 0}, {0.5, width, 0}), 16, 1e-9) << width;
  }
}

TEST(SurfaceDistance, ParallelSquaresAndATip) {
  const Surface low = testing::square(0), high = testing::square(0.25);
  const SurfaceDistance d = distanceOf(low, high);
  EXPECT_NEAR(d.max(), 0.25, 1e-12);
  EXPECT_NEAR(d.maxBound(), 0.25, 2e-4);
  EXPECT_NEAR(d.rms(), 0.25, 1e-12);
  EXPECT_NEAR(d.mean(), 0.25, 1e-12);
  EXPECT_NEAR(d.p99(), 0.25, 1e-12);
  // A pyramid's tip of height 1 over the square: at distance h over the base, mean 1/3, rms sqrt(1/6).
  Surface tip = testing::square(0);
  tip.points.push_back({0.5, 0.5, 1});
  tip.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const SurfaceDistance t = distanceOf(tip, low);
  EXPECT_NEAR(t.forward.max, 1, 1e-12);
  EXPECT_NEAR(t.forward.mean, 1.0 / 3, 1e-4);
  EXPECT_NEAR(t.forward.rms, std::sqrt(1.0 / 6), 1e-4);
  // The share of a side above height h is (1 - h)^2.
  EXPECT_NEAR(t.forward.p99, 0.9, 5e-3);
  // The farthest point of the square is its middle, at 1 / sqrt(5) from the sides: inside its triangles' edge.
  EXPECT_NEAR(t.backward.max, 0.5 / std::sqrt(1.25), 2e-4);
  EXPECT_GE(t.backward.max_bound, 0.5 / std::sqrt(1.25) - 1e-12);
  EXPECT_LE(t.backward.max_bound - t.backward.max, 1e-4 * std::sqrt(3.0) * 1.01);
}

TEST(SurfaceDistance, TheSameSurfaceIsAtZeroHoweverItIsCut) {
  const Surface ball = testing::sphere({0.1, 0.2, 0.3}, 1, 24);
  const SurfaceDistance same = distanceOf(ball, ball);
  EXPECT_LT(same.max(), 1e-15);
  EXPECT_LT(same.forward.pieces, 3 * ball.triangles.size()) << "equal meshes need no search";
  const Surface fine = testing::subdivided(ball);
  const SurfaceDistance cut = distanceOf(ball, fine);
  EXPECT_LT(cut.max(), 1e-12);
  EXPECT_LT(cut.maxBound(), 1e-3);
}

TEST(SurfaceDistance, SpheresAgainstClosedForms) {
  const Surface inner = testing::sphere({0, 0, 0}, 1, 64), outer = testing::sphere({0, 0, 0}, 1.25, 64);
  EXPECT_NEAR(distanceOf(inner, outer).rms(), 0.25, 2e-3);
  outofcore::ThreadExecutor executor(2);
  const OneWayDistance to = distanceToSphere(inner.view(), {0, 0, 0}, 1.25, {}, executor);
  EXPECT_GE(to.max_bound, to.max);
  EXPECT_LE(to.max_bound - to.max, 1e-4 * 2.5 * std::sqrt(3.0) * 1.01);
  EXPECT_NEAR(to.mean, 0.25, 2e-3);
  // Corners on the sphere, sagitta of the largest triangle inside it: second order.
  double last = 0;
  for (const std::size_t n : {16, 32, 64}) {
    const OneWayDistance own = distanceToSphere(testing::sphere({3, -2, 7}, 2, n).view(), {3, -2, 7}, 2, {}, executor);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / own.rms), 2, 0.1);
    }
    last = own.rms;
  }
}

TEST(SurfaceDistance, IsThatOfBruteForceOnRandomTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int round = 0; round < 4; ++round) {
    const Surface a = testing::soup(random, 60), b = testing::soup(random, 80);
    const SurfaceDistance d = distanceOf(a, b, {1e-3, 20'000});
    // Points of A by the thousand against every triangle of B: a lower bound of the maximum, and the mean.
    double most = 0;
    const TriangleTree tree(b.view());
    for (const Triangle& t : a.triangles) {
      for (int k = 0; k < 50; ++k) {
        double u = (unit(random) + 1) / 2, v = (unit(random) + 1) / 2;
        if (u + v > 1) u = 1 - u, v = 1 - v;
        Point3 p;
        for (std::size_t c = 0; c < 3; ++c) {
          p[c] = a.points[t[0]][c] * (1 - u - v) + a.points[t[1]][c] * u + a.points[t[2]][c] * v;
        }
        double nearest = std::numeric_limits<double>::infinity();
        for (const Triangle& s : b.triangles) {
          nearest = std::min(nearest, squaredDistance(p, b.points[s[0]], b.points[s[1]], b.points[s[2]]));
        }
        EXPECT_DOUBLE_EQ(tree.nearest(p, static_cast<std::uint32_t>(k)).squared, nearest);
        most = std::max(most, std::sqrt(nearest));
      }
    }
    EXPECT_LE(most, d.forward.max_bound);
    EXPECT_LE(d.forward.max_bound - d.forward.max, 1e-3 + 1e-12);
    EXPECT_LT(d.forward.max - most, 0.2) << "the samples come near";
  }
}

TEST(SurfaceDistance, DoesNotDependOnThreads) {
  std::mt19937 random(3);
  const Surface a = testing::soup(random, 3000), b = testing::soup(random, 2000);
  const SurfaceDistance one = distanceOf(a, b, {}, 1), many = distanceOf(a, b, {}, 5);
  EXPECT_EQ(one.forward.max, many.forward.max);
  EXPECT_EQ(one.forward.max_bound, many.forward.max_bound);
  EXPECT_EQ(one.backward.rms, many.backward.rms);
  EXPECT_EQ(one.forward.p99, many.forward.p99);
  EXPECT_EQ(one.backward.pieces, many.backward.pieces);
}

TEST(SurfaceDistanceStiff, EmptyMeshesAndSinglePoints) {
  const Surface empty, square = testing::square(0);
  EXPECT_EQ(distanceOf(empty, empty).max(), 0);
  EXPECT_TRUE(std::isinf(distanceOf(empty, square).max()));
  EXPECT_EQ(distanceOf(empty, square).forward.max, 0);
  Surface point;
  point.points = {{0.5, 0.5, 2}};
  point.triangles = {{0, 0, 0}};
  const SurfaceDistance d = distanceOf(point, square);
  EXPECT_DOUBLE_EQ(d.forward.max, 2);
  EXPECT_DOUBLE_EQ(d.forward.rms, 2);
  EXPECT_NEAR(d.backward.max, std::sqrt(4.5), 4e-4);
  EXPECT_EQ(distanceOf(point, point).maxBound(), 0);
}

TEST(SurfaceDistanceStiff, FarOriginsAndScalesLoseNothing) {
  for (const double scale : {1e-150, 1e-9, 1.0, 1e9, 1e150}) {
    Surface a = testing::sphere({0, 0, 0}, 1, 12), b = testing::sphere({0.125, 0, 0}, 1, 12);
    const double reference = distanceOf(a, b).rms();
    for (Surface* s : {&a, &b}) {
      for (Point3& p : s->points) {
        for (double& x : p) x *= scale;
      }
    }
    EXPECT_NEAR(distanceOf(a, b).rms() / scale, reference, 1e-12) << scale;
  }
  for (const double far : {1e3, 1e6, 1e8}) {
    // Multiples of 2^-20, so that moving them rounds nothing.
    Surface a = testing::sphere({0, 0, 0}, 1, 12), b = testing::sphere({0.125, 0, 0}, 1, 12);
    for (Surface* s : {&a, &b}) {
      for (Point3& p : s->points) {
        for (double& x : p) x = std::round(x * 1048576) / 1048576;
      }
    }
    const SurfaceDistance near = distanceOf(a, b);
    for (Surface* s : {&a, &b}) {
      for (Point3& p : s->points) p[0] += far, p[2] -= far;
    }
    EXPECT_NEAR(distanceOf(a, b).rms(), near.rms(), 1e-12) << far;
    EXPECT_NEAR(distanceOf(a, b).max(), near.max(), 1e-12) << far;
  }
}

TEST(SurfaceDistanceStiff, NeedlesAMillionToOne) {
  for (const double stretch : {1e3, 1e6}) {
    Surface a = testing::square(0), b = testing::square(1);
    for (Surface* s : {&a, &b}) {
      *s = testing::subdivided(testing::subdivided(*s));
      for (Point3& p : s->points) p[0] *= stretch;
    }
    const SurfaceDistance d = distanceOf(a, b);
    EXPECT_NEAR(d.max(), 1, 1e-9);
    EXPECT_NEAR(d.rms(), 1, 1e-9);
    EXPECT_LE(d.maxBound() - d.max(), 1e-4 * stretch * 1.01);
  }
}

TEST(SurfaceDistanceStiff, TrianglesWithoutAreaCountForTheMaximumOnly) {
  Surface a = testing::square(0);
  a.points.push_back({0, 0, 5});
  a.triangles.push_back({0, 0, 4});  // a spike
  const SurfaceDistance d = distanceOf(a, testing::square(0));
  EXPECT_DOUBLE_EQ(d.forward.max, 5);
  EXPECT_LT(d.forward.rms, 1e-15);
  EXPECT_LT(d.backward.max, 1e-15);
}

TEST(SurfaceDistanceStiff, AnEndedSearchSaysWhatIsProven) {
  const Surface a = testing::sphere({0, 0, 0}, 1, 16), b = testing::sphere({0.3, 0.1, 0}, 1, 17);
  const SurfaceDistance exact = distanceOf(a, b, {1e-6, 1000});
  const SurfaceDistance ended = distanceOf(a, b, {1e-12, 1000, 1});
  EXPECT_LE(ended.forward.max, exact.forward.max_bound);
  EXPECT_GE(ended.forward.max_bound, exact.forward.max);
  EXPECT_GT(ended.forward.max_bound - ended.forward.max, 1e-6);
}

TEST(SurfaceDistanceStiff, CoordinatesThatAreNoNumbersAreNamed) {
  Surface a = testing::square(0);
  a.points[2][1] = std::numeric_limits<double>::quiet_NaN();
  try {
    distanceOf(testing::square(0), a);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().file, "B");
    EXPECT_EQ(error.fault().place, "point 2");
  }
}

}  // namespace
}  // namespace tet4d::measure
