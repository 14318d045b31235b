// Pictures in files: row by row as whole, over the seams of a long film, and in bounded memory however large they are.
#include "libpreprocess/measure/picture_files.h"

#include <gtest/gtest.h>
#include <spng.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/read_png.h"

namespace tet4d::measure {
namespace {

namespace fs = std::filesystem;

using Fill = std::function<void(std::uint32_t y, std::vector<std::uint8_t>& row)>;

// Written row by row, so that the test needs no more memory than what it tests.
void writePng(const std::string& path, std::uint32_t width, std::uint32_t height, const Fill& fill,
              bool interlaced = false) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  spng_ctx* context = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_set_png_file(context, file);
  spng_ihdr header{
      width, height, 8, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, 0, 0, static_cast<std::uint8_t>(interlaced ? 1 : 0)};
  spng_set_ihdr(context, &header);
  spng_set_option(context, SPNG_IMG_COMPRESSION_LEVEL, 1);
  spng_set_option(context, SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_NONE);
  std::vector<std::uint8_t> row(std::size_t{4} * width);
  if (interlaced) {
    std::vector<std::uint8_t> all;
    for (std::uint32_t y = 0; y < height; ++y) fill(y, row), all.insert(all.end(), row.begin(), row.end());
    EXPECT_EQ(spng_encode_image(context, all.data(), all.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE), 0);
  } else {
    EXPECT_EQ(spng_encode_image(context, nullptr, 0, SPNG_FMT_PNG, SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE), 0);
    for (std::uint32_t y = 0; y < height; ++y) {
      fill(y, row);
      const int error = spng_encode_row(context, row.data(), row.size());
      EXPECT_TRUE(error == 0 || (error == SPNG_EOI && y + 1 == height)) << spng_strerror(error);
    }
  }
  spng_ctx_free(context);
  std::fclose(file);
}

Fill grey(std::uint8_t value) {
  return [=](std::uint32_t, std::vector<std::uint8_t>& row) {
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = i % 4 == 3 ? 255 : value;
  };
}

Fill noise(std::uint32_t seed) {
  return [=](std::uint32_t y, std::vector<std::uint8_t>& row) {
    std::uint32_t state = seed * 2654435761U + y * 40503U + 1;
    for (std::uint8_t& byte : row) {
      state = state * 1664525U + 1013904223U;
      byte = static_cast<std::uint8_t>(state >> 24);
    }
  };
}

class PictureFiles : public ::testing::Test {
 protected:
  PictureFiles() { fs::create_directories(folder_); }
  ~PictureFiles() override { fs::remove_all(folder_); }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }

 private:
  std::string folder_ = ::testing::TempDir() + "picture_files_test-" + std::to_string(::getpid());
};

TEST_F(PictureFiles, RowsAreThoseOfTheWholePicture) {
  for (const bool interlaced : {false, true}) {
    writePng(at("a.png"), 37, 23, noise(1), interlaced);
    const exchange::Picture whole = exchange::readPng(at("a.png"));
    exchange::PngRows rows(at("a.png"));
    ASSERT_EQ(rows.width(), 37U);
    ASSERT_EQ(rows.height(), 23U);
    for (std::size_t y = 0; y < 23; ++y) {
      const auto row = rows.next();
      ASSERT_TRUE(std::equal(row.begin(), row.end(), whole.rgba.begin() + static_cast<std::ptrdiff_t>(4 * 37 * y)))
          << y;
    }
  }
}

TEST_F(PictureFiles, ErrorsAreThoseOfTheViews) {
  writePng(at("a.png"), 31, 17, noise(1));
  writePng(at("b.png"), 31, 17, noise(2));
  writePng(at("c.png"), 17, 31, noise(2));
  const exchange::Picture a = exchange::readPng(at("a.png")), b = exchange::readPng(at("b.png"));
  const PictureError views = comparePictures({31, 17, a.rgba}, {31, 17, b.rgba});
  const PictureError files = comparePictureFiles(at("a.png"), at("b.png"));
  EXPECT_EQ(files.rmse, views.rmse);
  EXPECT_EQ(files.max, views.max);
  EXPECT_EQ(files.x, views.x);
  EXPECT_EQ(files.y, views.y);
  EXPECT_GT(files.y, 0U);
  try {
    comparePictureFiles(at("a.png"), at("c.png"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(error.fault().what.find("31x17"), std::string::npos);
    EXPECT_NE(error.fault().what.find("17x31"), std::string::npos);
  }
}

TEST_F(PictureFiles, ACutPictureIsNamed) {
  writePng(at("a.png"), 64, 64, noise(1));
  fs::copy_file(at("a.png"), at("cut.png"));
  fs::resize_file(at("cut.png"), fs::file_size(at("a.png")) / 2);
  try {
    comparePictureFiles(at("cut.png"), at("a.png"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(error.fault().file.find("cut.png"), std::string::npos);
  }
}

// 75 pictures are three parts; errors pop at the seams, where a part alone would not see it.
TEST_F(PictureFiles, FlickerReachesOverSeams) {
  std::vector<std::string> film, exact;
  writePng(at("white.png"), 5, 3, grey(255));
  writePng(at("black.png"), 5, 3, grey(0));
  std::vector<double> error(75, 0.0);
  for (const std::size_t k : {0U, 29U, 30U, 31U, 32U, 47U, 60U, 61U, 62U, 74U}) error[k] = 1;
  for (std::size_t k = 0; k < error.size(); ++k) {
    film.push_back(at(error[k] > 0 ? "white.png" : "black.png"));
    exact.push_back(at("black.png"));
  }
  double bends = 0;
  for (std::size_t k = 1; k + 1 < error.size(); ++k) bends += std::pow(error[k - 1] - 2 * error[k] + error[k + 1], 2);
  FilmMeter meter;
  addFilm(film, exact, meter);
  EXPECT_NEAR(meter.flicker(), std::sqrt(bends / 73), 1e-12);
  EXPECT_NEAR(meter.rmse(), std::sqrt(10.0 / 75), 1e-12);
  exact.pop_back();
  EXPECT_THROW(addFilm(film, exact, meter), Error);
}

std::size_t peakKib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss);
}

// 16384 x 8192 pixels, 512 MiB each if they were held; a film of them would hold several.
TEST_F(PictureFiles, LargePicturesTakeTheMemoryOfRows) {
  constexpr std::uint32_t kWidth = 16384, kHeight = 8192;
  const auto spot = [](std::uint32_t y, std::vector<std::uint8_t>& row) {
    grey(0)(y, row);
    if (y == 8000) row[4 * 16000] = 255;
  };
  writePng(at("black.png"), kWidth, kHeight, grey(0));
  writePng(at("spot.png"), kWidth, kHeight, spot);
  const std::size_t before = peakKib();
  const PictureError error = comparePictureFiles(at("spot.png"), at("black.png"));
  EXPECT_DOUBLE_EQ(error.max, 1);
  EXPECT_EQ(error.x, 16000U);
  EXPECT_EQ(error.y, 8000U);
  EXPECT_NEAR(error.rmse, std::sqrt(1.0 / (3.0 * kWidth * kHeight)), 1e-15);
  EXPECT_LT(peakKib() - before, 16U * 1024) << "KiB more than before";
}

}  // namespace
}  // namespace tet4d::measure
