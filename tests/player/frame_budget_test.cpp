#include "player/scene/frame_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "player/scene/drawn_kinds.h"
#include "player/scene/pages_ahead.h"
#include "tests/player/swept_mesh.h"

namespace tet4d {
namespace {

using scene::FrameBudget;
using scene::FrameWork;
using scene::MotionQuality;
using scene::Quality;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(FrameBudget, FindsTheCostsOfAnExactMachine) {
  FrameBudget budget(10);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> some(0, 1);
  for (int i = 0; i < 64; ++i) {
    const FrameWork work{1e6 * some(random), 1e7 * some(random), 1e6 * some(random)};
    budget.add(work, 2 + 3e-6 * work.primitives + 2e-7 * work.bytes + 1e-6 * work.samples);
  }
  EXPECT_NEAR(budget.predictMs({}), 2, 0.02);
  EXPECT_NEAR(budget.predictMs({1e6, 0, 0}), 5, 0.05);
  EXPECT_NEAR(budget.predictMs({0, 1e7, 0}), 4, 0.05);
  EXPECT_NEAR(budget.predictMs({0, 0, 1e6}), 3, 0.05);
  EXPECT_NEAR(budget.primitives({0, 1e7, 1e6}), (10 - 2 - 2 - 1) / 3e-6, 0.05 / 3e-6);
  EXPECT_LT(budget.report().error_p50, 0.05);
}

// A chooser that obeys, on a machine with noise: how long its frames take.
template <class Machine>
std::vector<double> run(FrameBudget& budget, Machine machine, int frames, double wanted = 1e7) {
  std::vector<double> all;
  for (int i = 0; i < frames; ++i) {
    const FrameWork work{std::min(wanted, budget.primitives({0, 0, 1e6})), 0, 1e6};
    all.push_back(machine(i, work));
    budget.add(work, all.back());
  }
  return all;
}

double share(const std::vector<double>& ms, std::size_t from, double limit) {
  const auto over =
      std::count_if(ms.begin() + static_cast<std::ptrdiff_t>(from), ms.end(), [&](double m) { return m > limit; });
  return static_cast<double>(over) / static_cast<double>(ms.size() - from);
}

TEST(FrameBudget, NoisyFramesMeetTheTargetNineteenTimesOfTwenty) {
  FrameBudget budget(20);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(1, 0.1);
  const auto ms = run(
      budget, [&](int, const FrameWork& w) { return (3 + 2e-6 * w.primitives) * noise(random); }, 600);
  EXPECT_LE(share(ms, 50, 20), 0.08);
  double mean = 0;
  for (std::size_t i = 50; i < ms.size(); ++i) mean += ms[i] / static_cast<double>(ms.size() - 50);
  EXPECT_GT(mean, 12) << "the budget is used";
}

TEST(FrameBudgetStiff, ATenfoldSlowdownIsAnsweredWithinTenFramesAndForgotten) {
  FrameBudget budget(20);
  const auto ms = run(
      budget, [](int i, const FrameWork& w) { return (1 + 2e-6 * w.primitives) * (i >= 100 && i < 200 ? 10 : 1); },
      320);
  for (std::size_t i = 112; i < 200; ++i) EXPECT_LE(ms[i], 21) << i;
  EXPECT_GT(ms[319], 15) << "fast again, and used again";
}

TEST(FrameBudgetStiff, SingleOutliersChangeLittle) {
  FrameBudget budget(20);
  const auto ms = run(
      budget, [](int i, const FrameWork& w) { return i % 30 == 7 ? 500 : 2 + 2e-6 * w.primitives; }, 300);
  for (std::size_t i = 60; i < 300; ++i) {
    if (i % 30 == 7) continue;
    EXPECT_GT(ms[i], 10) << i;
    EXPECT_LE(ms[i], 21) << i;
  }
}

TEST(FrameBudgetStiff, ConstantCostAndNoWorkAtAll) {
  FrameBudget constant(10);
  for (int i = 0; i < 100; ++i) constant.add({1000.0 * (i % 7), 0, 0}, 5);
  EXPECT_NEAR(constant.predictMs({1e4, 0, 0}), 5, 0.3);
  EXPECT_GT(constant.primitives({}), 1e5);
  FrameBudget idle(10);
  for (int i = 0; i < 100; ++i) idle.add({}, 0);
  EXPECT_EQ(idle.predictMs({}), 0);
  EXPECT_EQ(idle.primitives({}), kInfinite);
  EXPECT_EQ(idle.report().error_p95, 0);
}

TEST(FrameBudgetStiff, NoFramesNoTargetAndNothingToSpend) {
  EXPECT_EQ(FrameBudget(10).primitives({}), kInfinite);
  EXPECT_EQ(FrameBudget(10).report().p95_ms, 0);
  FrameBudget none(0), endless(kInfinite);
  for (FrameBudget* budget : {&none, &endless}) budget->add({1e6, 0, 0}, 30);
  EXPECT_EQ(none.primitives({}), 0);
  EXPECT_EQ(endless.primitives({}), kInfinite);
  EXPECT_TRUE(endless.fits({1e12, 0, 0}));
  EXPECT_FALSE(none.fits({}));
}

TEST(FrameBudgetStiff, TimesAndCountsThatAreNone) {
  FrameBudget budget(10);
  budget.add({1, 0, 0}, std::nan(""));
  budget.add({1, 0, 0}, kInfinite);
  budget.add({1, 0, 0}, -1);
  budget.add({kInfinite, 0, 0}, 1);
  EXPECT_EQ(budget.report().frames, 0u);
  for (int i = 0; i < 20; ++i) budget.add({1e-300, 1e300, 0}, 1e-9);
  EXPECT_TRUE(std::isfinite(budget.predictMs({1, 1, 1})));
}

TEST(FrameBudgetStiff, AFixedCostAboveTheTargetLeavesNothing) {
  FrameBudget budget(5);
  for (int i = 0; i < 64; ++i) budget.add({1e5 * (i % 8), 0, 0}, 9 + 1e-5 * (i % 8) * 1e5);
  EXPECT_EQ(budget.primitives({}), 0);
}

TEST(MotionQuality, FallsAtOnceRisesSlowlyAndIsFullAtRest) {
  const double pixels = 1e6;
  FrameBudget budget(20);
  MotionQuality quality(16);
  const auto cost = [](const Quality& q, double slow) {
    return slow * (1 + 1.2e-6 * q.samples * 1e6 / (q.divide * q.divide));
  };
  const auto step = [&](double slow, bool is_moving) {
    const Quality q = quality.next(budget, pixels, 1000, 0, is_moving);
    budget.add({1000, 0, pixels * q.samples / (q.divide * q.divide)}, cost(q, slow));
    return q;
  };
  EXPECT_EQ(step(1, true), (Quality{16, 1})) << "nothing is known yet";
  for (int i = 0; i < 40; ++i) step(1, true);
  EXPECT_EQ(step(1, true), (Quality{9, 1})) << "12 ms fit, 20.2 do not";
  EXPECT_EQ(step(1, false), (Quality{16, 1})) << "at rest";
  for (int i = 0; i < 12; ++i) step(20, true);
  EXPECT_LT(cost(step(20, true), 20), 35) << "the least there is, or within the target";
  EXPECT_GT(step(20, true).divide, 1u);
  for (int i = 0; i < 200; ++i) step(0.1, true);
  EXPECT_EQ(step(0.1, true), (Quality{16, 1}));
}

// Pictures of a renderer with a budget, as players hand them on. Milliseconds by samples a pixel.
struct Motion {
  FrameBudget budget{50};
  MotionQuality quality{4};
  double pixels = 1280.0 * 720;
  template <class Machine>
  double step(Machine machine, bool is_moving = true, bool is_learnt = true) {
    const Quality q = quality.next(budget, pixels, 250000, 0, is_moving);
    const double samples = static_cast<double>(q.samples) / (q.divide * q.divide);
    last_ms = machine(samples);
    if (is_learnt) budget.add({250000, 0, samples * pixels}, last_ms);
    return samples;
  }
  double last_ms = 0;
};

// What OpenGL takes without a GPU: vertices whatever the samples, and four samples more than four times one.
double softwareGl(double samples) { return 24 + 14 * samples + (samples > 1 ? 66 : 0); }

TEST(MotionQuality, OneSampleThatFitsIsNotLeftForASixteenthOfIt) {
  Motion motion;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(motion.step(softwareGl, false), 4) << "at rest, 146 ms";
  int tries = 0;
  for (int i = 0; i < 600; ++i) {
    const double samples = motion.step(softwareGl);
    tries += i > 1 && samples > 1 ? 1 : 0;
    if (i > 1) {
      EXPECT_GE(samples, 1) << "38 of 50 ms, picture " << i;
    }
  }
  EXPECT_LE(tries, 5) << "of four samples, ever more seldom";
}

// As it is where the budget was lowered by something else for a while: a step that would fit is found again.
TEST(MotionQuality, SamplesComeBackThatAModelOfLinesThinksTooSlow) {
  Motion motion;
  for (int i = 0; i < 5; ++i) motion.step(softwareGl, false);
  const auto busy = [](double samples) { return 6 * softwareGl(samples); };
  for (int i = 0; i < 20; ++i) motion.step(busy);
  EXPECT_LT(motion.step(busy), 0.3);
  int late = 0;
  double samples = 0;
  for (int i = 0; i < 200; ++i) {
    samples = motion.step(softwareGl);
    late += motion.last_ms > 50 && i > 5 ? 1 : 0;
    if (i > 80) {
      EXPECT_GE(samples, 1) << i;
    }
  }
  EXPECT_LE(late, 6) << "of 200";
}

TEST(MotionQuality, WhatSavesLittleIsNotGivenUp) {
  Motion motion;
  const auto vertices = [](double samples) { return 70 + samples; };  // above the target whatever is given up
  int coarse = 0;
  for (int i = 0; i < 300; ++i) coarse += motion.step(vertices) < 4 ? 1 : 0;
  EXPECT_LE(coarse, 6);
}

// Coarse pictures for longer than the window is: what samples cost is not forgotten with the last fine one.
TEST(MotionQuality, LongCoarseFilmsDoNotForgetWhatSamplesCost) {
  for (const double slow : {1.0, 2.5, 6.0}) {
    FrameBudget budget{33};
    MotionQuality quality{4};
    const double pixels = 1024.0 * 1024;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> noise(0.9, 1.15);
    for (int i = 0; i < 600; ++i) {
      const double primitives = 60000 + 80 * i;
      const Quality q = quality.next(budget, pixels, primitives, 0, i > 0);
      const double samples = static_cast<double>(q.samples) / (q.divide * q.divide);
      const double ms = slow * noise(random) * (9 + 1e-4 * primitives + 28 * samples);
      budget.add({primitives, 0, samples * pixels}, ms);
      if (i > 2) {
        EXPECT_LT(samples, 4) << "picture " << i << " of " << ms << " ms, " << slow;
      }
    }
  }
}

// Nothing fits for the length of one picture, the first at its level: that level saves as much as before.
TEST(MotionQuality, OneSlowCoarsePictureDoesNotBringBackTheFinest) {
  Motion motion;
  bool was_slow = false;
  const auto machine = [&](double samples) {
    if (samples > 1) return 150.0;
    if (samples > 0.2) return samples == 1 ? 60.0 : 55.0;
    return was_slow ? 30.0 : 140.0;
  };
  for (int i = 0; i < 5; ++i) motion.step(machine, false);
  motion.step(machine);
  for (int i = 0; i < 20; ++i) {
    const double samples = motion.step(machine);
    if (was_slow) {
      EXPECT_LT(samples, 4) << i;
    }
    was_slow = was_slow || samples < 0.2;
  }
  EXPECT_TRUE(was_slow);
}

// The first picture of a renderer links its programs. Players leave it out of what they learn from.
TEST(MotionQuality, ASlowFirstPictureDoesNotLowerTheNextTwenty) {
  const auto machine = [](double samples) { return 5 + 8 * samples; };
  for (const bool is_moving : {false, true}) {
    Motion motion;
    scene::DrawnKinds kinds;
    scene::DrawList list;
    list.surfaces.resize(1);
    list.surfaces[0].items.push_back({0, 0, 250000});
    for (int i = 0; i < 21; ++i) {
      const bool is_first = kinds.isFirst(list);
      EXPECT_EQ(is_first, i == 0);
      const auto slow = [&](double samples) { return machine(samples) + (is_first ? 450 : 0); };
      EXPECT_EQ(motion.step(slow, i > 0 || is_moving, !is_first), 4) << i;
    }
  }
}

TEST(MotionQuality, NorDoesASlowOneLater) {
  Motion motion;
  for (int i = 0; i < 200; ++i) {
    const auto machine = [&](double samples) { return 5 + 8 * samples + (i == 3 || i % 50 == 49 ? 450 : 0); };
    EXPECT_EQ(motion.step(machine), 4) << i;
  }
}

// A single slow picture that was learnt is not the machine: two are.
TEST(MotionQuality, AFirstPictureThatWasLearntIsTriedAgain) {
  Motion motion;
  const auto machine = [](double samples) { return 5 + 8 * samples; };
  motion.step([&](double samples) { return machine(samples) + 450; });
  for (int i = 0; i < 60; ++i) motion.step(machine);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(motion.step(machine), 4) << i;
}

TEST(DrawnKinds, AreToldByWhatNeedsAProgramOfItsOwn) {
  scene::DrawnKinds kinds;
  scene::DrawList list;
  EXPECT_TRUE(kinds.isFirst(list)) << "the background";
  EXPECT_FALSE(kinds.isFirst(list));
  list.surfaces.resize(2);
  EXPECT_FALSE(kinds.isFirst(list)) << "surfaces of which nothing is drawn";
  list.surfaces[1].items.push_back({0, 0, 1});
  const auto first = [&] { return kinds.isFirst(list) && !kinds.isFirst(list); };
  EXPECT_TRUE(first());
  list.smooth = false;
  EXPECT_TRUE(first());
  list.surfaces[1].refraction = 1.3F;
  EXPECT_TRUE(first());
  list.surfaces[1].column.emplace();
  EXPECT_TRUE(first());
  list.surfaces[1].normal_column = 0;
  EXPECT_TRUE(first());
  list = {};
  list.surfaces.resize(1);
  list.surfaces[0].items.push_back({3, 0, 9});
  EXPECT_FALSE(kinds.isFirst(list)) << "as before, whatever the file";
}

TEST(MotionQualityStiff, TargetsOfNothingAndOfEverything) {
  FrameBudget none(0), endless(kInfinite);
  MotionQuality coarse(4), fine(4);
  none.add({1, 0, 1}, 1);
  endless.add({1, 0, 1}, 1e9);
  EXPECT_EQ(coarse.next(none, 100, 1, 0, true), (Quality{1, 4}));
  EXPECT_EQ(coarse.next(none, 100, 1, 0, false), (Quality{4, 1}));
  EXPECT_EQ(fine.next(endless, 100, 1, 0, true), (Quality{4, 1}));
}

TEST(PagesAhead, NamesWhatComesWithTheSecondsUntilThen) {
  const auto file = std::move(dyntri::File::open(test::writeTestSphere("ahead.t4d", 9))).value();
  const scene::WorldBox box = scene::worldBox(file.header().index_to_world, file.header().bounds);
  const scene::DrawList list = scene::makeDrawList(box, scene::defaultShot(box, 1.5), {}, true);
  const auto ask = [&](float t, const scene::Playing& playing) {
    auto wants = scene::pagesAhead(file.geometryEntries(), t, 8, playing, list, list.surfaces[0]);
    std::sort(wants.begin(), wants.end(), [](const auto& a, const auto& b) { return a.urgency < b.urgency; });
    return wants;
  };
  EXPECT_EQ(ask(2.5f, {}).size(), 1u);
  const auto forward = ask(2.5f, {2, 1, std::nullopt});
  ASSERT_EQ(forward.size(), 3u);  // 2, then 3 after 0.25 s, 4 after 0.75 s
  EXPECT_EQ(forward[1].page, 3u);
  EXPECT_NEAR(forward[1].urgency, 0.25, 1e-9);
  EXPECT_EQ(forward[2].page, 4u);
  EXPECT_NEAR(forward[2].urgency, 0.75, 1e-9);
  const auto backward = ask(2.5f, {-2, 1, std::nullopt});
  ASSERT_EQ(backward.size(), 3u);
  EXPECT_EQ(backward[1].page, 1u);
  EXPECT_NEAR(backward[1].urgency, 0.25, 1e-9);
  const auto looped = ask(7.5f, {2, 1, std::pair(0.0, 8.0)});
  ASSERT_EQ(looped.size(), 3u);
  EXPECT_EQ(looped[1].page, 0u);
  EXPECT_NEAR(looped[1].urgency, 0.25, 1e-9);
  EXPECT_EQ(looped[2].page, 1u);
  EXPECT_TRUE(ask(9, {1, 5, std::nullopt}).empty()) << "after the end";
}

}  // namespace
}  // namespace tet4d
