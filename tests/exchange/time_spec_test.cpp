#include "formats/core/time_spec.h"

#include <gtest/gtest.h>

#include <vector>

namespace tet4d {
namespace {

const std::vector<double> kTimes{10, 11, 13, 13.5};

TEST(TimeSpec, WorldTimesAndFrames) {
  const SliceTime world = parseTime("12", kTimes).value();
  EXPECT_EQ(world.frame, 1.5);
  EXPECT_EQ(world.time, 12);
  const SliceTime frame = parseTime("2.5f", kTimes).value();
  EXPECT_EQ(frame.frame, 2.5);
  EXPECT_EQ(frame.time, 13.25);
  EXPECT_EQ(parseTime("+1.1e1", kTimes).value().frame, 1);
  EXPECT_EQ(parseTime("3f", kTimes).value().time, 13.5);
  EXPECT_EQ(parseTime("13.5", kTimes).value().frame, 3);
}

TEST(TimeSpec, EndsTolerateARounding) {
  EXPECT_EQ(parseTime("13.500000000001", kTimes).value().frame, 3);
  EXPECT_EQ(parseTime("-0.000000001f", kTimes).value().frame, 0);
  EXPECT_FALSE(parseTime("13.50001", kTimes).ok());
}

TEST(TimeSpec, RefusalsNameTheRange) {
  for (const char* text : {"9.9", "14", "3.1f", "-1f", "1e300"}) {
    const auto result = parseTime(text, kTimes);
    ASSERT_FALSE(result.ok()) << text;
    EXPECT_EQ(result.fault().code, FaultCode::kUsage);
    EXPECT_NE(result.fault().remedy.find("10 to 13.5"), std::string::npos) << result.fault().remedy;
    EXPECT_NE(result.fault().remedy.find("0f to 3f"), std::string::npos) << result.fault().remedy;
  }
  for (const char* text : {"", "f", "x", "1ff", "1 ", "nan", "inf", "12:", "--1"})
    EXPECT_FALSE(parseTime(text, kTimes).ok()) << text;
}

TEST(TimeSpec, RangesIncludeBothEnds) {
  const auto frames = parseTimes("0f:3f:0.5f", kTimes).value();
  ASSERT_EQ(frames.size(), 7u);
  EXPECT_EQ(frames.front().frame, 0);
  EXPECT_EQ(frames[3].time, 12);
  EXPECT_EQ(frames.back().frame, 3);
  EXPECT_EQ(parseTimes("0f:3f:2", kTimes).value().size(), 2u) << "an end that is no step is left out";
  EXPECT_EQ(parseTimes("11:11:1", kTimes).value().size(), 1u);
  EXPECT_EQ(parseTimes("12", kTimes).value().size(), 1u);
}

TEST(TimeSpec, DecimalStepsReachTheEndExactly) {
  const std::vector<double> times{0, 1};
  const auto steps = parseTimes("0:1:0.1", times).value();  // 10 * 0.1 rounds, as do sums of 0.1
  ASSERT_EQ(steps.size(), 11u);
  EXPECT_EQ(steps.back().time, 1);
  EXPECT_EQ(parseTimes("0.3:0.9:0.2", times).value().size(), 4u);
  EXPECT_EQ(parseTimes("0.3:0.9:0.2", times).value().back().time, 0.9);
}

TEST(TimeSpec, BadRanges) {
  for (const char* text : {"0f:3:1", "0:3f:1", "10:13:1f", "10:12:0", "10:12:-1", "12:10:1", "10:14:1", "9:12:1",
                           "10:12", "10:12:1:1", "10:12:1e-9", "10:12:nan", "::", "a:b:c"}) {
    const auto result = parseTimes(text, kTimes);
    ASSERT_FALSE(result.ok()) << text;
    EXPECT_EQ(result.fault().code, FaultCode::kUsage);
    EXPECT_FALSE(result.fault().remedy.empty());
  }
}

TEST(TimeSpec, OneFrameHasOneTime) {
  const std::vector<double> times{4};
  EXPECT_EQ(parseTime("4", times).value().frame, 0);
  EXPECT_EQ(parseTime("0f", times).value().time, 4);
  EXPECT_FALSE(parseTime("4.1", times).ok());
}

std::vector<double> framesOf(const char* text) {
  std::vector<double> frames;
  const auto times = parseTimeList(text, kTimes);
  if (!times.ok()) return frames;
  for (const SliceTime& time : times.value()) frames.push_back(time.frame);
  return frames;
}

TEST(TimeSpec, ListsRunForwardBackwardAndJump) {
  EXPECT_EQ(framesOf("2f"), (std::vector<double>{2}));
  EXPECT_EQ(framesOf("2f:0f:-1f"), (std::vector<double>{2, 1, 0}));
  EXPECT_EQ(framesOf("0f:1f:0.5f,3f,12,2f:1f:-0.4f"), (std::vector<double>{0, 0.5, 1, 3, 1.5, 2, 1.6, 1.2}));
  EXPECT_EQ(framesOf("1f:1f:-1f"), (std::vector<double>{1}));
  for (const char* text : {"", ",", "1f,", "0f:2f:-1f", "2f:0f:1f", "2f:0f:0f", "1f,9f", "3f:0f:-1e-9f"})
    EXPECT_FALSE(parseTimeList(text, kTimes).ok()) << text;
}

}  // namespace
}  // namespace tet4d
