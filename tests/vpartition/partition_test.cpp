// Owners by brute force, balance and norms of relaxed cells, samples that stand for all.
#include "libpreprocess/vpartition/partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "libpreprocess/vpartition/voronoi.h"

namespace tet4d::vpartition {
namespace {

constexpr std::int64_t kMost = std::int64_t{1} << (kPlaceBits + 2);

Place randomPlace(std::mt19937_64& random, std::int64_t most = kMost) {
  std::uniform_int_distribution<std::int64_t> along(0, most);
  return {along(random), along(random), along(random), along(random)};
}

TEST(Voronoi, TheOwnerIsTheNearestSiteByItsOwnNorm) {
  std::mt19937_64 random(3);
  for (const std::size_t count : {1U, 2U, 5U, 64U, 700U}) {
    // On a coarse grid many distances are equal, and sites share places.
    for (const std::int64_t most : {kMost, std::int64_t{6}}) {
      std::vector<Site> sites(count);
      std::uniform_int_distribution<std::uint64_t> weight(kLeastTime, kMostTime);
      for (Site& site : sites) site = {randomPlace(random, most), most < 10 ? kEven : weight(random)};
      const Voronoi cells(sites);
      for (int i = 0; i < 2000; ++i) {
        const Place at = randomPlace(random, most);
        std::uint32_t nearest = 0;
        for (std::uint32_t s = 1; s < count; ++s)
          if (distance(sites[s], at) < distance(sites[nearest], at)) nearest = s;
        ASSERT_EQ(cells.ownerOf(at), nearest) << count << " sites";
      }
    }
  }
}

TEST(Voronoi, DistancesOfTheFarthestPlacesDoNotWrap) {
  const Site site{{0, 0, 0, 0}, kMostTime};
  const double exact = static_cast<double>(kMost) * static_cast<double>(kMost) * (3.0 * kEven + kMostTime);
  EXPECT_DOUBLE_EQ(static_cast<double>(distance(site, {kMost, kMost, kMost, kMost})), exact);
  EXPECT_LT(exact, 0x1p63);
}

std::vector<Sample> cloud(std::size_t count, double space2, double time2, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Sample> samples(count);
  for (Sample& sample : samples) sample = {randomPlace(random), 2.5, space2, time2};
  return samples;
}

std::vector<double> weights(const Partition& partition, const std::vector<Sample>& samples) {
  std::vector<double> sums(partition.cells());
  for (const Sample& sample : samples) sums[partition.ownerOf(sample.at)] += sample.weight;
  return sums;
}

TEST(Partition, CellsAreOfAboutTheSameWeight) {
  const std::vector<Sample> samples = cloud(20000, 2, 1, 5);
  for (const Kind kind : {Kind::kVoronoi, Kind::kKd}) {
    for (const std::uint32_t level : {1U, 2U, 3U}) {
      const auto partition = makePartition(kind, samples, 40, level, 7);
      ASSERT_EQ(partition->cells(), 40U);
      const std::vector<double> sums = weights(*partition, samples);
      const double mean = 2.5 * 20000 / 40;
      EXPECT_LE(*std::max_element(sums.begin(), sums.end()), 1.6 * mean);
      EXPECT_GE(*std::min_element(sums.begin(), sums.end()), mean / 4);
    }
  }
}

// A dense corner takes its share of the cells, and no cell all of it.
TEST(Partition, CrowdsAreDivided) {
  std::vector<Sample> samples = cloud(2000, 2, 1, 5);
  std::mt19937_64 random(8);
  for (int i = 0; i < 18000; ++i) samples.push_back({randomPlace(random, kMost / 64), 2.5, 2, 1});
  for (const Kind kind : {Kind::kVoronoi, Kind::kKd}) {
    const auto partition = makePartition(kind, samples, 50, 1, 7);
    const std::vector<double> sums = weights(*partition, samples);
    EXPECT_LE(*std::max_element(sums.begin(), sums.end()), 2.5 * 2.5 * 20000 / 50);
  }
}

TEST(Partition, LevelsAndSeedsHaveOtherBorders) {
  const std::vector<Sample> samples = cloud(4000, 2, 1, 5);
  const auto together = [&](const Partition& a, const Partition& b) {
    std::map<std::uint32_t, std::set<std::uint32_t>> met;
    for (const Sample& sample : samples) met[a.ownerOf(sample.at)].insert(b.ownerOf(sample.at));
    std::size_t pairs = 0;
    for (const auto& [cell, others] : met) pairs += others.size();
    return pairs;
  };
  for (const Kind kind : {Kind::kVoronoi, Kind::kKd}) {
    const auto one = makePartition(kind, samples, 12, 1, 7), two = makePartition(kind, samples, 12, 2, 7),
               again = makePartition(kind, samples, 12, 1, 7);
    EXPECT_EQ(together(*one, *again), 12U);
    EXPECT_GT(together(*one, *two), 24U);
  }
  EXPECT_GT(
      together(*makePartition(Kind::kVoronoi, samples, 12, 1, 7), *makePartition(Kind::kVoronoi, samples, 12, 1, 8)),
      24U);
}

// Tetrahedra that are long in time make cells that are long in time: norms that count time less.
TEST(Partition, NormsFollowTheTetrahedra) {
  const auto timeOf = [](double space2, double time2) {
    double sum = 0;
    const std::vector<Site> sites = relaxedSites(cloud(8000, space2, time2, 5), 32, 9);
    for (const Site& site : sites) sum += static_cast<double>(site.time) / kEven / 32;
    return sum;
  };
  EXPECT_NEAR(timeOf(2, 1), 1, 0.01);          // as long in time as along each direction of space
  EXPECT_NEAR(timeOf(2, 16), 1.0 / 16, 0.01);  // four times as long
  EXPECT_NEAR(timeOf(32, 1), 16, 0.1);
  EXPECT_NEAR(timeOf(2, 1e9), 1.0 / 64, 0.01) << "clamped";
  EXPECT_NEAR(timeOf(2, 0), 64, 0.1) << "all at one instant";
}

TEST(Partition, AsManyCellsAsSamplesAtMostAndOneAtLeast) {
  const std::vector<Sample> few = cloud(3, 2, 1, 5);
  for (const Kind kind : {Kind::kVoronoi, Kind::kKd}) {
    EXPECT_LE(makePartition(kind, few, 100, 1, 7)->cells(), 3U);
    EXPECT_EQ(makePartition(kind, {}, 100, 1, 7)->cells(), 1U);
    // All at one place: no border, so one cell owns it.
    const std::vector<Sample> same(50, Sample{{4, 4, 4, 4}, 1, 1, 1});
    const auto partition = makePartition(kind, same, 8, 1, 7);
    EXPECT_LT(partition->ownerOf({4, 4, 4, 4}), partition->cells());
  }
}

TEST(Sampler, EveryTetrahedronIsStoodForAndEveryTimeIsThere) {
  Sampler sampler(400, 10, 3);
  std::array<std::uint64_t, 10> count{};
  // A thousand times as much happens in the third frame.
  for (std::uint64_t k = 0; k < 10; ++k) {
    for (std::uint64_t i = 0; i < (k == 3 ? 50000U : 50U); ++i) {
      sampler.add({{static_cast<std::int64_t>(i), 0, 0, static_cast<std::int64_t>(k)}, 1, 1, 1},
                  static_cast<double>(k) + 0.5);
      ++count[k];
    }
  }
  std::array<double, 10> weight{};
  double along = 0;
  for (const Sample& sample : sampler.take()) {
    const auto k = static_cast<std::size_t>(sample.at[3]);
    weight[k] += sample.weight;
    if (k == 3) along += sample.weight * static_cast<double>(sample.at[0]);
  }
  for (std::size_t k = 0; k < 10; ++k) EXPECT_NEAR(weight[k], static_cast<double>(count[k]), 1e-6) << k;
  EXPECT_NEAR(along / 50000, 25000, 8000) << "the mean of forty of them";
}

TEST(Lattice, APlaceIsWhereAPointLiesInLengths) {
  // Cells of 2 x 1 x 0.5, sheared, mirrored; the mean cell is 1.
  const AffineMap map{{1e7, -3, 2}, {{{-2, 0, 0}, {0.5, 1, 0}, {0, 0, 0.5}}}};
  const Bounds4f bounds{{-3, 0, 10, 0}, {40, 25, 50, 30}};
  const Lattice lattice(bounds, map, 3);
  const auto apart = [&](const Vec4f& a, const Vec4f& b) {
    const Place p = lattice.placeOf(a), q = lattice.placeOf(b);
    double sum = 0;
    for (std::size_t axis = 0; axis < 4; ++axis) sum += std::pow(static_cast<double>(p[axis] - q[axis]), 2);
    return std::sqrt(sum) * lattice.step();
  };
  EXPECT_NEAR(apart({0, 3, 20, 4}, {5, 3, 20, 4}), 10, 1e-3);
  EXPECT_NEAR(apart({0, 3, 20, 4}, {0, 7, 20, 4}), 4 * std::hypot(0.5, 1), 1e-3);
  EXPECT_NEAR(apart({0, 3, 20, 4}, {0, 3, 26, 4}), 3, 1e-3);
  EXPECT_NEAR(apart({0, 3, 20, 4}, {0, 3, 20, 9}), 15, 1e-3);
  for (unsigned corner = 0; corner < 16; ++corner) {
    const Vec4f v{(corner & 1) != 0 ? bounds.max.x : bounds.min.x, (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                  (corner & 4) != 0 ? bounds.max.z : bounds.min.z, (corner & 8) != 0 ? bounds.max.t : bounds.min.t};
    for (const std::int64_t along : lattice.placeOf(v)) {
      EXPECT_GE(along, 0);
      EXPECT_LE(along, std::int64_t{1} << kPlaceBits);
    }
  }
  EXPECT_EQ(Lattice(Bounds4f{}, map, 1).placeOf({5, 5, 5, 5}), Place{}) << "of nothing";
}

TEST(Lattice, TimeThatIsMuchFinerOrCoarserThanSpaceHasPlacesToo) {
  const Bounds4f bounds{{0, 0, 0, 0}, {20, 20, 20, 10}};
  for (const double scale : {1e-9, 1e-3, 1e3, 1e9}) {
    const Lattice lattice(bounds, {}, scale);
    const Place last = lattice.placeOf({20, 20, 20, 10});
    EXPECT_GE(*std::max_element(last.begin(), last.end()), std::int64_t{1} << (kPlaceBits - 1));
    EXPECT_LE(*std::max_element(last.begin(), last.end()), std::int64_t{1} << kPlaceBits);
  }
}

}  // namespace
}  // namespace tet4d::vpartition
