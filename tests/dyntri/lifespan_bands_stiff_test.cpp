// Bands and their index against brute force: nothing alive at any time is left out, however the lifespans lie.
#include "libpreprocess/dyntri/lifespan_bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "formats/core/tet_slice.h"

namespace tet4d::dyntri {
namespace {

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 20;

struct Banded {
  std::vector<Lifespan> lives;  // as bands order them
  PageView view;
  BandPlan plan;
  std::vector<Alive> index;
};

Banded banded(const std::vector<Lifespan>& lives, std::uint32_t bands = kDefaultBands, std::uint64_t bytes = kPlenty) {
  Banded all;
  const Lifespan whole = unionOf(lives);
  all.plan = planBands(lives, whole, bands, bytes);
  std::vector<std::size_t> order(lives.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return all.plan.bucket[a] < all.plan.bucket[b]; });
  for (const std::size_t i : order) all.lives.push_back(lives[i]);
  all.index = indexBands(all.plan.bands, all.lives, whole);
  all.view.lifespans = all.lives;
  all.view.bands = all.plan.bands;
  all.view.index = all.index;
  all.view.interval = whole;
  return all;
}

struct Counts {
  std::uint64_t processed = 0, drawn = 0;
};

// Fails if a triangle alive at t is in no run.
Counts check(const Banded& all, float t) {
  const float last_t = all.view.interval.end;
  std::vector<bool> handed(all.lives.size(), false);
  Counts counts;
  for (const Band& band : all.view.bands) {
    const auto [first, last] = all.view.aliveIn(band, t);
    EXPECT_LE(band.first, first);
    EXPECT_LE(last, band.first + band.count);
    for (std::uint64_t i = first; i < last; ++i) handed[i] = true;
    counts.processed += last - first;
  }
  for (std::size_t i = 0; i < all.lives.size(); ++i) {
    if (!isAlive(all.lives[i].begin, all.lives[i].end, t, last_t)) continue;
    EXPECT_TRUE(handed[i]) << "t " << t << ", life " << all.lives[i].begin << " .. " << all.lives[i].end;
    ++counts.drawn;
  }
  return counts;
}

// At every begin and end, beside them, and between.
void checkEverywhere(const Banded& all) {
  const auto [begin, end] = all.view.interval;
  std::vector<float> times{begin, end, begin + (end - begin) / 3};
  for (const Lifespan& life : all.lives) {
    for (const float t : {life.begin, life.end}) {
      times.insert(times.end(), {t, std::nextafter(t, begin), std::nextafter(t, end)});
    }
  }
  for (const float t : times) {
    if (t >= begin && t <= end) check(all, t);
  }
}

TEST(LifespanBandsStiff, RandomLivesOfManyLengthsLoseNothingAndProcessLittle) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Lifespan> lives;
  for (int i = 0; i < 20000; ++i) {
    const double length = std::exp2(-10 * unit(random)), begin = unit(random) * (1 - length);
    lives.push_back({static_cast<float>(7 + begin), static_cast<float>(7 + begin + length)});
    if (!(lives.back().begin < lives.back().end)) lives.pop_back();
  }
  std::vector<double> ratios;
  for (const std::uint32_t bands : {1u, 3u, 6u, kMostBands}) {
    const Banded all = banded(lives, bands);
    EXPECT_LE(all.plan.bands.size(), bands);
    Counts sum;
    for (int k = 0; k < 60; ++k) {
      const Counts at = check(all, 7 + static_cast<float>(unit(random)));
      sum.processed += at.processed, sum.drawn += at.drawn;
    }
    ratios.push_back(static_cast<double>(sum.processed) / static_cast<double>(sum.drawn));
  }
  EXPECT_GT(ratios[0], 2);
  EXPECT_LT(ratios[2], 1.33);
  EXPECT_TRUE(std::is_sorted(ratios.rbegin(), ratios.rend())) << "more bands, fewer dead";
}

TEST(LifespanBandsStiff, NoneOneAndAllAlike) {
  EXPECT_TRUE(banded({}).plan.bands.empty());
  EXPECT_TRUE(banded({}).index.empty());
  const Banded one = banded({{2, 3}});
  ASSERT_EQ(one.plan.bands.size(), 1u);
  checkEverywhere(one);
  const Banded alike = banded(std::vector<Lifespan>(1000, {0, 1}), 16);
  EXPECT_EQ(alike.plan.bands.size(), 1u);
  const Counts at = check(alike, 0.5F);
  EXPECT_EQ(at.processed, 1000u);
  EXPECT_EQ(at.drawn, 1000u);
}

TEST(LifespanBandsStiff, LivesOfABillionthOfTheWhole) {
  std::vector<Lifespan> lives{{0, 1}};
  float t = 1e-3F;
  for (int i = 0; i < 500; ++i) {
    const float next = std::nextafter(t, 1.0F);
    lives.push_back({t, next});
    t += 1e-3F;
  }
  for (const std::uint32_t bands : {1u, 2u, 6u}) checkEverywhere(banded(lives, bands));
}

TEST(LifespanBandsStiff, DenormalAndHugeTimes) {
  const float tiny = std::numeric_limits<float>::denorm_min(), huge = std::numeric_limits<float>::max();
  std::vector<Lifespan> lives;
  for (int i = 0; i < 50; ++i) {
    lives.push_back({static_cast<float>(i) * tiny, static_cast<float>(i + 1 + i % 7) * tiny});
  }
  checkEverywhere(banded(lives));
  lives.push_back({-huge, huge});
  lives.push_back({-huge, -huge / 2});
  lives.push_back({huge / 2, huge});
  checkEverywhere(banded(lives));
}

TEST(LifespanBandsStiff, FramesAndNothingBetween) {
  // Alive 0 .. 1 and 2 .. 3: none at 1.5; lives meet at frames.
  const Banded gap = banded({{0, 1}, {2, 3}, {0, 0.5F}, {0.5F, 1}, {2, 2.5F}, {2.5F, 3}});
  checkEverywhere(gap);
  EXPECT_EQ(check(gap, 1.5F).drawn, 0u);
  EXPECT_EQ(check(gap, 1).drawn, 0u) << "half-open";
  EXPECT_EQ(check(gap, 3).drawn, 2u) << "closed at the last time";
}

TEST(LifespanBandsStiff, BytesAreKept) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Lifespan> lives;
  while (lives.size() < 3000) {
    const float a = unit(random), b = unit(random) * unit(random);
    if (a < a + b) lives.push_back({a, a + b});
  }
  for (const std::uint64_t bytes : {0u, 100u, 1000u, 4000u}) {
    const Banded all = banded(lives, kMostBands, bytes);
    const std::uint64_t taken = all.plan.bands.size() * sizeof(Band) + all.index.size() * sizeof(Alive);
    EXPECT_LE(taken, std::max<std::uint64_t>(bytes, sizeof(Band) + sizeof(Alive)));
    checkEverywhere(all);
  }
}

}  // namespace
}  // namespace tet4d::dyntri
