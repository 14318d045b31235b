// Normals, velocities and fields on the surface, against closed forms.
#include "libpreprocess/hypermesh/vertex_columns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "libpreprocess/error.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::hypermesh {
namespace {

using testing::extract;
using testing::ExtractedMesh;
using testing::MemoryFrames;
using Vec3 = std::array<double, 3>;

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec3 tripleAt(const std::vector<float>& column, std::size_t v) {
  return {column[3 * v], column[3 * v + 1], column[3 * v + 2]};
}

// A ball in world space: centre c + v t, radius r + g t; the field is the distance to its surface.
struct Ball {
  Vec3 centre, velocity;
  double radius, growth;
  double value(const Vec3& p, double t) const { return radius + growth * t - distance(p, t); }
  double distance(const Vec3& p, double t) const {
    const Vec3 d = offset(p, t);
    return std::sqrt(dot(d, d));
  }
  Vec3 offset(const Vec3& p, double t) const {
    return {p[0] - centre[0] - velocity[0] * t, p[1] - centre[1] - velocity[1] * t, p[2] - centre[2] - velocity[2] * t};
  }
};

MemoryFrames<float> framesOf(const Ball& ball, const AffineMap& map, const std::vector<double>& times,
                             std::uint64_t n) {
  MemoryFrames<float> frames({n, n, n}, times.size(), [&](auto x, auto y, auto z, auto k) {
    const Vec3 p = toWorld(map, {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
    return static_cast<float>(ball.value(p, times[k]));
  });
  frames.map(map).times(times);
  return frames;
}

struct Errors {
  double worst_angle = 0, worst_speed = 0;  // degrees; relative to the greatest exact speed
};

Errors errorsOf(const ExtractedMesh& mesh, const Ball& ball, const AffineMap& map, const std::vector<double>& times) {
  Errors errors;
  const double greatest = std::sqrt(dot(ball.velocity, ball.velocity)) + std::abs(ball.growth);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec4f& at = mesh.vertices[v];
    const double t = timeOfFrame(times, at.t);
    Vec3 normal = ball.offset(toWorld(map, {at.x, at.y, at.z}), t);
    const double length = std::sqrt(dot(normal, normal));
    for (double& c : normal) c /= length;
    const Vec3 ours = tripleAt(mesh.columns[0], v), velocity = tripleAt(mesh.columns[1], v);
    EXPECT_NEAR(dot(ours, ours), 1, 1e-5);
    errors.worst_angle =
        std::max(errors.worst_angle, std::acos(std::clamp(dot(ours, normal), -1.0, 1.0)) * 180 / 3.14159265);
    const double speed = dot(ball.velocity, normal) + ball.growth;
    errors.worst_speed = std::max(errors.worst_speed, std::abs(dot(velocity, ours) - speed) / greatest);
    // A velocity is along the normal.
    EXPECT_NEAR(std::sqrt(dot(velocity, velocity)), std::abs(dot(velocity, ours)), 1e-4 * greatest);
  }
  return errors;
}

const AffineMap kSheared{{100, -50, 7}, {{{2, 0, 0}, {0.5, 1.5, 0}, {0, -0.3, 1}}}};
const AffineMap kMirrored{{0, 0, 0}, {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};

TEST(VertexColumns, NormalsAndVelocityOfAMovingBall) {
  const std::vector<double> even{0, 0.5, 1, 1.5, 2, 2.5}, uneven{10, 10.25, 11, 11.125, 12, 12.5};
  for (const AffineMap& map : {AffineMap{}, kSheared, kMirrored}) {
    for (const std::vector<double>& times : {even, uneven}) {
      const double mid = (times.front() + times.back()) / 2;
      const Vec3 centre = toWorld(map, {11.3, 12.1, 11.8}), velocity{0.7, -0.4, 0.3};
      const Ball ball{{centre[0] - mid * velocity[0], centre[1] - mid * velocity[1], centre[2] - mid * velocity[2]},
                      velocity,
                      7.2 - 0.2 * mid,
                      0.2};
      MemoryFrames<float> source = framesOf(ball, map, times, 24);
      const Errors gradient =
          errorsOf(extract(source, {.iso = 0, .normals = Normals::kGradient, .velocity = true}), ball, map, times);
      EXPECT_LT(gradient.worst_angle, 1.5);
      EXPECT_LT(gradient.worst_speed, 0.05);
      const ExtractedMesh mesh = extract(source, {.iso = 0, .normals = Normals::kTets, .velocity = true});
      const Errors sums = errorsOf(mesh, ball, map, times);
      EXPECT_LT(sums.worst_angle, 25);  // few tetrahedra at a vertex of the first and last time
      // On the mean over the vertices the sums are good.
      double mean = 0;
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vec4f& at = mesh.vertices[v];
        const Vec3 normal = ball.offset(toWorld(map, {at.x, at.y, at.z}), timeOfFrame(times, at.t));
        mean += dot(tripleAt(mesh.columns[0], v), normal) / std::sqrt(dot(normal, normal));
      }
      EXPECT_GT(mean / static_cast<double>(mesh.vertices.size()), std::cos(5.0 / 180 * 3.14159265));
    }
  }
}

TEST(VertexColumns, APlaneThatMovesIsExact) {
  // x = 3.1 + 0.4 t; sums and gradients see one normal and one speed everywhere, times 1/100 apart.
  MemoryFrames<double> source({9, 5, 5}, 5, [](auto x, auto, auto, auto k) {
    return 3.1 + 0.4 * static_cast<double>(k) - static_cast<double>(x);
  });
  source.times({1, 1.01, 1.02, 1.03, 1.04});
  for (const Normals normals : {Normals::kTets, Normals::kGradient, Normals::kNone}) {
    const ExtractedMesh mesh = extract(source, {.iso = 0, .normals = normals, .velocity = true});
    const std::vector<float>& velocity = mesh.columns.back();
    ASSERT_EQ(mesh.columns.size(), normals == Normals::kNone ? 1U : 2U);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      if (normals != Normals::kNone) {
        EXPECT_NEAR(mesh.columns[0][3 * v], 1, 1e-5);
      }
      EXPECT_NEAR(velocity[3 * v], 40, 0.01);
      EXPECT_NEAR(velocity[3 * v + 1], 0, 0.01);
    }
  }
}

TEST(VertexColumnsStiff, ASurfaceThatAppearsAtOnceHasAFiniteSpeed) {
  MemoryFrames<float> source({5, 5, 5}, 4, [](auto, auto, auto, auto k) { return k < 2 ? 0.0F : 1.0F; });
  for (const Normals normals : {Normals::kTets, Normals::kGradient}) {
    const ExtractedMesh mesh = extract(source, {.iso = 0.5, .normals = normals, .velocity = true});
    ASSERT_FALSE(mesh.vertices.empty());
    for (const std::vector<float>& column : mesh.columns)
      for (const float value : column) EXPECT_EQ(value, 0) << "no direction in space";
  }
}

TEST(VertexColumnsStiff, TimeUnitsAndSpacingsFarApart) {
  for (const double unit : {1e-9, 1.0, 1e9}) {
    for (const double spacing : {1e-3, 1.0, 1e3}) {
      MemoryFrames<double> source({9, 5, 5}, 4, [](auto x, auto, auto, auto k) {
        return 3.1 + 0.4 * static_cast<double>(k) - static_cast<double>(x);
      });
      source.times({0, unit, 2 * unit, 3 * unit});
      source.map({{1e7, 0, 0}, {{{1, 0, 0}, {0, spacing, 0}, {0, 0, 1 / spacing}}}});
      for (const Normals normals : {Normals::kTets, Normals::kGradient}) {
        const ExtractedMesh mesh = extract(source, {.iso = 0, .normals = normals, .velocity = true});
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
          EXPECT_NEAR(mesh.columns[0][3 * v], 1, 1e-4);
          EXPECT_NEAR(mesh.columns[1][3 * v] * unit, 0.4, 1e-3) << unit << " " << spacing;
        }
      }
    }
  }
}

TEST(VertexColumnsStiff, NansBesideTheSurfaceLeaveFiniteNormals) {
  MemoryFrames<float> source({6, 6, 6}, 4, [](auto x, auto y, auto, auto) {
    return (x + y) % 3 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(x % 2);
  });
  for (const Normals normals : {Normals::kTets, Normals::kGradient}) {
    const ExtractedMesh mesh = extract(source, {.iso = 0.5, .normals = normals, .velocity = true});
    ASSERT_FALSE(mesh.vertices.empty());
    for (const std::vector<float>& column : mesh.columns)
      for (const float value : column) EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(VertexColumns, AFieldIsSampledLinearly) {
  // Linear in space and time: interpolation along an edge is exact.
  const auto linear = [](double x, double y, double z, double k) { return 1 + 2 * x - 3 * y + 0.5 * z + 7 * k; };
  MemoryFrames<float> source({8, 7, 6}, 5, [](auto x, auto y, auto z, auto k) {
    return static_cast<float>(std::sin(static_cast<double>(x * 3 + y * 5 + z * 7 + k * 2)));
  });
  MemoryFrames<double> field({8, 7, 6}, 5, [&](auto x, auto y, auto z, auto k) {
    return linear(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z), static_cast<double>(k));
  });
  for (const Split split : {Split::kHull, Split::kKuhn}) {
    const ExtractedMesh mesh =
        extract(source, {.iso = 0.1, .more_isos = {-0.6}, .split = split, .fields = {{"heat", &field}}});
    ASSERT_EQ(mesh.columns.size(), 1U);
    ASSERT_GT(mesh.vertices.size(), 1000U);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vec4f& at = mesh.vertices[v];
      EXPECT_NEAR(mesh.columns[0][v], linear(at.x, at.y, at.z, at.t), 1e-4);
    }
    EXPECT_EQ(mesh.stats.fields_xxh3.size(), 1U);
  }
}

// The field's frames are what the frames' are; otherwise the field is named.
void expectRefused(MemoryFrames<float> source, MemoryFrames<float> field, const std::string& what) {
  try {
    extract(source, {.iso = 1.5, .fields = {{"heat", &field}}});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().place, "field heat");
    EXPECT_NE(error.fault().what.find(what), std::string::npos) << error.fault().what;
  }
}

TEST(VertexColumns, AFieldThatIsNotOnTheFramesIsRefused) {
  const auto make = [](std::array<std::uint64_t, 3> dims, std::size_t frames) {
    return MemoryFrames<float>(dims, frames, [](auto x, auto, auto, auto) { return static_cast<float>(x); });
  };
  const MemoryFrames<float> source = make({4, 4, 4}, 3);
  MemoryFrames<float> stream = source;
  stream.asStream();
  AffineMap shifted;
  shifted.origin = {0.5, 0, 0};
  for (const MemoryFrames<float>& frames : {source, stream}) {
    expectRefused(frames, make({4, 4, 3}, 3), "grid is 4 x 4 x 3");
    expectRefused(frames, make({4, 4, 4}, 3).map(shifted), "origin");
    expectRefused(frames, make({4, 4, 4}, 3).times({0, 1, 2.5}), "at time");
  }
  expectRefused(source, make({4, 4, 4}, 2), "2 frames");
  expectRefused(stream, make({4, 4, 4}, 1), "ends after 1");
  expectRefused(stream, make({4, 4, 4}, 2), "ends after 2");
  expectRefused(stream, make({4, 4, 4}, 4), "more frames than the 3");
  MemoryFrames<float> streamed_field = make({4, 4, 4}, 2);
  expectRefused(source, streamed_field.asStream(), "ends after 2");
}

}  // namespace
}  // namespace tet4d::hypermesh
