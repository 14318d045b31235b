// Quadrics against the distances they stand for; placements against minima known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libpreprocess/qslim4d/placement.h"
#include "libpreprocess/qslim4d/quadric.h"
#include "libpreprocess/qslim4d/space.h"

namespace tet4d::qslim4d {
namespace {

glm::dvec4 randomVector(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  return {number(random), number(random), number(random), number(random)};
}

TEST(Cross4, IsTheDeterminantsGradient) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec4 u = randomVector(random), v = randomVector(random), w = randomVector(random);
    const glm::dvec4 n = cross4(u, v, w);
    for (const glm::dvec4& edge : {u, v, w}) EXPECT_NEAR(glm::dot(n, edge), 0, 1e-12);
    EXPECT_GT(glm::dot(n, n), 0);
  }
  const glm::dvec4 n = cross4({0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1});
  EXPECT_EQ(n, glm::dvec4(1, 0, 0, 0)) << "det(n, u, v, w) > 0 for n along N";
}

TEST(Quadric, IsTheSumOfSquaredDistancesAboutAnyOrigin) {
  std::mt19937 random(2);
  Quadric q;
  std::vector<glm::dvec4> planes;
  for (int i = 0; i < 5; ++i) {
    planes.push_back(randomVector(random));
    q.addPlane(planes.back(), 2, 1);
  }
  const auto brute = [&](const glm::dvec4& d) {
    double sum = 0;
    for (const glm::dvec4& n : planes) sum += 2 * glm::dot(n, d) * glm::dot(n, d);
    return sum;
  };
  const glm::dvec4 offset(0.5, -2, 3, 0.25);
  const Quadric moved = q.about(offset), back = moved.about(-offset);
  for (int i = 0; i < 50; ++i) {
    const glm::dvec4 d = 3.0 * randomVector(random);
    EXPECT_NEAR(q.value(d), brute(d), 1e-9);
    EXPECT_NEAR(moved.value(d - offset), brute(d), 1e-9);
    EXPECT_NEAR(back.value(d), brute(d), 1e-8);
  }
  EXPECT_EQ(q.value(glm::dvec4(0)), 0);
}

// Hyperplanes x = 0.5, y = 0.25, z = 0.75 and t = 0.4 meet in one point.
Quadric corner() {
  Quadric q;
  const glm::dvec4 point(0.5, 0.25, 0.75, 0.4);
  for (int c = 0; c < 4; ++c) {
    glm::dvec4 n(0);
    n[c] = 1;
    q.addPlane(n, 1, 1);
  }
  return q.about(-point);
}

TEST(Placement, FreeMinimumIsFoundUpToThePull) {
  const Placement p = placeVertex(corner(), {0, 0, 0, 0}, {1, 1, 1, 1}, {}, 0, false, {});
  EXPECT_FALSE(p.aligned);
  EXPECT_NEAR(p.at.x, 0.5, 2e-3);
  EXPECT_NEAR(p.at.y, 0.25, 2e-3);
  EXPECT_NEAR(p.at.z, 0.75, 2e-3);
  EXPECT_NEAR(p.at.t, 0.4, 2e-3);
  EXPECT_LT(p.error, 2e-3);
}

TEST(Placement, TimeIsAlignedWhereItCostsLittle) {
  Quadric still;  // planes that say nothing of time
  for (int c = 0; c < 3; ++c) {
    glm::dvec4 n(0);
    n[c] = 1;
    still.addPlane(n, 1, 1);
  }
  const Placement p =
      placeVertex(still.about({-0.5, -0.5, -0.5, 0}), {0, 0, 0, 3.25F}, {1, 1, 1, 3.75F}, {}, 0.25, true, {});
  EXPECT_TRUE(p.aligned);
  EXPECT_TRUE(p.at.t == 3.25F || p.at.t == 3.75F) << p.at.t;
  const Placement over = placeVertex(corner(), {0, 0, 0, 0}, {1, 1, 1, 1}, {}, 1e9, false, {});
  EXPECT_TRUE(over.aligned);
  EXPECT_TRUE(over.at.t == 0 || over.at.t == 1);
}

TEST(Placement, FixedCoordinatesAreExact) {
  const Fixed fixed{1u << 0 | 1u << 3, {0.125F, 9, 9, 0.875F}};
  const Placement p = placeVertex(corner(), {0, 0, 0, 0}, {1, 1, 1, 1}, fixed, 0.25, true, {});
  EXPECT_EQ(p.at.x, 0.125F);
  EXPECT_EQ(p.at.t, 0.875F);
  EXPECT_NEAR(p.at.y, 0.25, 2e-3);
  EXPECT_NEAR(p.at.z, 0.75, 2e-3);
}

TEST(PlacementStiff, FlatFarAndNeedleQuadricsGiveFiniteNearPlaces) {
  Quadric flat;  // one hyperplane: rank 1
  flat.addPlane({1e-8, 0, 0, 0}, 1e8, 1e-8);
  for (const auto& [u, v] : {std::pair<Vec4f, Vec4f>{{1e7F, 0, 0, 0}, {1e7F + 1, 1, 0, 0}},
                             std::pair<Vec4f, Vec4f>{{0, 0, 0, 0}, {0, 1e6F, 0, 1e-6F}},
                             std::pair<Vec4f, Vec4f>{{5, 5, 5, 5}, {5, 5, 5, 5}}}) {
    for (const Quadric& q : {flat, Quadric{}}) {
      const Placement p = placeVertex(q, u, v, {}, 0.25, true, {});
      const glm::dvec4 off = difference(p.at, u), edge = difference(v, u);
      EXPECT_TRUE(std::isfinite(p.cost) && std::isfinite(p.error));
      EXPECT_LE(glm::length(off), 2 * glm::length(edge) + 1e-6 * std::abs(u.x));
    }
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
