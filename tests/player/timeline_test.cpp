#include "player/host/timeline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tet4d::host {
namespace {

Timeline timelineOf(std::vector<double> times) {
  Timeline timeline;
  timeline.setTable(std::move(times));
  return timeline;
}

TEST(Timeline, PlaysTwelveFramesASecondAndStopsAtTheEnd) {
  Timeline timeline = timelineOf({10, 10.5, 11, 11.5});
  timeline.setLoop(Loop::kOnce);
  timeline.play(true);
  EXPECT_TRUE(timeline.advance(1.0 / 12));
  EXPECT_NEAR(timeline.time(), 10.5, 1e-12);
  EXPECT_NEAR(timeline.frame(), 1, 1e-9);
  for (int i = 0; i < 3; ++i) timeline.advance(0.2);
  EXPECT_EQ(timeline.time(), 11.5);
  EXPECT_FALSE(timeline.playing());
  timeline.play(true);
  EXPECT_EQ(timeline.time(), 10) << "from the begin again";
}

TEST(Timeline, LoopsAndTurnsRound) {
  Timeline timeline = timelineOf({0, 1, 2});  // 24 units a second are 12 frames of 1
  timeline.play(true);
  timeline.advance(0.25);
  EXPECT_NEAR(timeline.time(), 1, 1e-9) << "3 of 2: once round";
  timeline.setLoop(Loop::kPingPong);
  timeline.setTime(1.5);
  timeline.advance(1.0 / 12);
  EXPECT_NEAR(timeline.time(), 1.5, 1e-9) << "2 and back";
  EXPECT_TRUE(timeline.backward());
  timeline.advance(1.0 / 12);
  EXPECT_NEAR(timeline.time(), 0.5, 1e-9);
  timeline.advance(1.0 / 12);
  EXPECT_NEAR(timeline.time(), 0.5, 1e-9);
  EXPECT_FALSE(timeline.backward());
}

TEST(Timeline, PlaysWithinItsRange) {
  Timeline timeline = timelineOf({0, 1, 2, 3, 4, 5, 6, 7, 8});
  timeline.setBegin(2);
  timeline.setEnd(4);
  timeline.setTime(2);
  timeline.play(true);
  for (int i = 0; i < 500; ++i) {
    timeline.advance(0.013);
    ASSERT_GE(timeline.time(), 2);
    ASSERT_LE(timeline.time(), 4);
  }
  const std::vector<double> expected{2, 2.5, 3, 3.5, 4};
  EXPECT_EQ(timeline.filmTimes(1), expected);
  timeline.setBegin(6);
  EXPECT_EQ(timeline.end(), 8) << "the other end gives way";
  timeline.setEnd(1);
  EXPECT_EQ(timeline.begin(), 0);
}

TEST(Timeline, StepsToFramesFromBetweenThem) {
  Timeline timeline = timelineOf({0, 1, 4});
  timeline.setTime(2.5);
  EXPECT_NEAR(timeline.frame(), 1.5, 1e-12);
  timeline.step(1);
  EXPECT_EQ(timeline.time(), 4);
  timeline.step(1);
  EXPECT_EQ(timeline.time(), 4);
  timeline.setTime(2.5);
  timeline.step(-1);
  EXPECT_EQ(timeline.time(), 1);
  timeline.step(-5);
  EXPECT_EQ(timeline.time(), 0);
}

TEST(Timeline, AnotherFileKeepsTheTime) {
  Timeline timeline = timelineOf({0, 1, 2});
  timeline.setTime(1.25);
  timeline.setTable({0, 1, 2, 3});
  EXPECT_EQ(timeline.time(), 1.25);
  EXPECT_EQ(timeline.end(), 3);
  timeline.setTable({5, 6});
  EXPECT_EQ(timeline.time(), 5);
}

TEST(TimelineStiff, UnitsOfTimeFromNanosecondsToAeons) {
  for (const double unit : {1e-9, 1.0, 1e9, 1e30}) {
    for (const double first : {0.0, 1e3 * unit}) {
      Timeline timeline = timelineOf({first, first + unit, first + 2 * unit});
      timeline.play(true);
      timeline.advance(1.0 / 24);
      EXPECT_NEAR((timeline.time() - first) / unit, 0.5, 1e-9);
    }
  }
}

TEST(TimelineStiff, OneFrameNoneAndStalls) {
  Timeline none;
  none.play(true);
  EXPECT_FALSE(none.playing());
  none.step(1);
  none.setSpeed(std::nan(""));
  EXPECT_FALSE(none.advance(1));
  Timeline one = timelineOf({7});
  one.play(true);
  EXPECT_FALSE(one.playing());
  EXPECT_EQ(one.filmTimes(4), std::vector<double>{7});
  Timeline between = timelineOf({0, 1, 2});
  between.setBegin(1.25);
  between.setEnd(1.5);
  EXPECT_EQ(between.filmTimes(0), std::vector<double>{1.25}) << "a range between two frames";
  Timeline two = timelineOf({0, 1000, 2000, 3000, 4000, 5000, 6000, 7000});
  two.play(true);
  two.advance(3600);
  EXPECT_NEAR(two.time(), 3000, 1e-6) << "a quarter of a second, however long it was";
}

}  // namespace
}  // namespace tet4d::host
