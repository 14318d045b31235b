#include "libpreprocess/measure/picture_error.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "libpreprocess/error.h"
#include "libpreprocess/measure/field_error.h"
#include "libpreprocess/measure/run_record.h"

namespace tet4d::measure {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes filled(std::size_t pixels, std::uint8_t value, std::uint8_t alpha = 255) {
  Bytes rgba(4 * pixels, value);
  for (std::size_t i = 0; i < pixels; ++i) rgba[4 * i + 3] = alpha;
  return rgba;
}

TEST(PictureError, BlackAndWhite) {
  const Bytes black = filled(6, 0);
  Bytes white = filled(6, 255);
  const PictureError far = comparePictures({3, 2, white}, {3, 2, black});
  EXPECT_DOUBLE_EQ(far.rmse, 1);
  EXPECT_DOUBLE_EQ(far.max, 1);
  EXPECT_EQ(comparePictures({3, 2, white}, {3, 2, white}).rmse, 0);
  // One colour of one pixel of six.
  Bytes spot = black;
  spot[4 * 4 + 1] = 255;
  const PictureError one = comparePictures({3, 2, spot}, {3, 2, black});
  EXPECT_NEAR(one.rmse, std::sqrt(1.0 / 18), 1e-12);
  EXPECT_EQ(one.x, 1U);
  EXPECT_EQ(one.y, 1U);
}

TEST(PictureError, IsInLinearLightAndMultipliedByAlpha) {
  // sRGB byte 188 is about half of the light of 255.
  EXPECT_NEAR(comparePictures({2, 2, filled(4, 188)}, {2, 2, filled(4, 0)}).rmse, 0.503, 1e-3);
  // A colour that nothing shows is no difference.
  EXPECT_EQ(comparePictures({2, 2, filled(4, 200, 0)}, {2, 2, filled(4, 10, 0)}).max, 0);
  EXPECT_NEAR(comparePictures({2, 2, filled(4, 255, 51)}, {2, 2, filled(4, 0)}).rmse, 0.2, 1e-6);
}

TEST(PictureError, SizesThatDifferAreNamed) {
  try {
    comparePictures({3, 2, filled(6, 0)}, {2, 3, filled(6, 0)});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(error.fault().what.find("3x2 and 2x3"), std::string::npos);
  }
}

// A film of one row.
FilmMeter filmOf(const std::vector<Bytes>& pictures, const std::vector<Bytes>& references) {
  FilmMeter meter;
  meter.addRow(std::vector<FilmMeter::Row>(pictures.begin(), pictures.end()),
               std::vector<FilmMeter::Row>(references.begin(), references.end()));
  return meter;
}

TEST(FilmMeter, FlickerIsTheSecondDifferenceOfTheError) {
  const Bytes black = filled(4, 0), white = filled(4, 255);
  std::vector<Bytes> blacks(6, black), whites(6, white), popping(6, black), moving(6, black);
  popping[2] = white;
  for (std::size_t k = 0; k < 6; k += 2) moving[k] = white;
  EXPECT_EQ(filmOf(whites, blacks).flicker(), 0) << "an error that stays is no flicker";
  EXPECT_DOUBLE_EQ(filmOf(whites, blacks).rmse(), 1);
  EXPECT_EQ(filmOf(moving, moving).flicker(), 0) << "what the reference does is no flicker";
  // Second differences of (0 0 1 0 0 0): 1, -2, 1, 0.
  const FilmMeter pop = filmOf(popping, blacks);
  EXPECT_NEAR(pop.flicker(), std::sqrt(6.0 / 4), 1e-12);
  EXPECT_DOUBLE_EQ(pop.flickerMax(), 2);
  EXPECT_NEAR(pop.rmse(), std::sqrt(1.0 / 6), 1e-12);
  EXPECT_EQ(FilmMeter().flicker(), 0);
  EXPECT_THROW(filmOf({black, filled(3, 0)}, {black, black}), Error);
}

TEST(FieldError, MaxRmsAndWhatIsUnlike) {
  FieldError error;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  error.add(std::vector<float>{1, 2, kNan, kNan, kInfinity}, std::vector<float>{1, 5, kNan, 1, kInfinity});
  error.add(std::vector<float>{-4, kInfinity}, std::vector<float>{0, -kInfinity});
  EXPECT_EQ(error.samples(), 7U);
  EXPECT_DOUBLE_EQ(error.max(), 4);
  EXPECT_EQ(error.worst(), 5U);
  EXPECT_DOUBLE_EQ(error.rms(), std::sqrt(25.0 / 3));
  EXPECT_EQ(error.unlike(), 2U);
}

class RunRecords : public ::testing::Test {
 protected:
  std::string written(const std::string& text) {
    std::ofstream(path_) << text;
    return path_;
  }
  ~RunRecords() override { std::filesystem::remove(path_); }

 private:
  std::string path_ = ::testing::TempDir() + "run_record_test-" + std::to_string(::getpid()) + ".json";
};

TEST_F(RunRecords, AreReadWithWhatIsNewPassedOver) {
  const RunRecord record = readRunRecord(written(
      R"({"program": "p", "options": {}, "counts": {"tets": 7}, "seconds_wall": 1.5, "seconds_cpu": 2, "peak_bytes": 9,
          "phases": [{"name": "read", "seconds_wall": 0.25, "seconds_cpu": 0.5}], "error": {"a": 0.5, "b": null},
          "frames": [{"time": 1, "ms": 3.5, "drawn": 4, "processed": 5, "bytes_touched": 6, "new": 1}], "new": []})"));
  EXPECT_EQ(record.count("tets"), 7U);
  EXPECT_EQ(record.count("none"), 0U);
  EXPECT_DOUBLE_EQ(record.phaseSeconds("read"), 0.25);
  EXPECT_EQ(record.errors.size(), 1U);
  ASSERT_EQ(record.frames.size(), 1U);
  EXPECT_DOUBLE_EQ(record.frames[0].ms, 3.5);
}

TEST_F(RunRecords, WhatIsMissingIsNamed) {
  for (const char* text :
       {"", "[]", "{", R"({"program": "p"})", R"({"program": 3})", R"({"program": "p", "counts": {"tets": "many"}})"}) {
    EXPECT_THROW(readRunRecord(written(text)), Error) << text;
  }
  EXPECT_THROW(readRunRecord("none.json"), Error);
}

TEST(Percentile, IsAValueThatOccurs) {
  EXPECT_EQ(percentile({5, 1, 3}, 0.5), 3);
  EXPECT_EQ(percentile({5, 1, 3}, 0.95), 5);
  EXPECT_EQ(percentile({5, 1, 3}, 0), 1);
  EXPECT_EQ(percentile({}, 0.5), 0);
}

}  // namespace
}  // namespace tet4d::measure
