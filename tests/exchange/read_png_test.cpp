#include "libpreprocess/exchange/read_png.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

// 3x2 pixels, RGB: 0 1 2 … 17; written by another library.
constexpr unsigned char kPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0x12, 0x16, 0xf1, 0x4d, 0x00,
    0x00, 0x00, 0x1c, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60, 0x60, 0x64, 0x62, 0x66, 0x61, 0x65,
    0x63, 0xe7, 0x60, 0xe0, 0xe4, 0xe2, 0xe6, 0xe1, 0xe5, 0xe3, 0x17, 0x10, 0x04, 0x00, 0x04, 0x01, 0x00,
    0x9a, 0xfc, 0xa8, 0xd3, 0xf3, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
};

class ReadPng : public ::testing::Test {
 protected:
  std::string written(std::span<const unsigned char> bytes) {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    for (const unsigned char byte : bytes) file.put(static_cast<char>(byte));
    return path_;
  }
  ~ReadPng() override { std::filesystem::remove(path_); }

 private:
  std::string path_ = ::testing::TempDir() + "read_png_test-" + std::to_string(::getpid()) + ".png";
};

TEST_F(ReadPng, PixelsFromTheTopOpaque) {
  const Picture picture = readPng(written(kPng));
  ASSERT_EQ(picture.width, 3U);
  ASSERT_EQ(picture.height, 2U);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(picture.rgba[4 * i + c], 3 * i + c);
    EXPECT_EQ(picture.rgba[4 * i + 3], 255);
  }
}

TEST_F(ReadPng, EveryPrefixIsRefusedByName) {
  // Without the last chunk all pixels are there already.
  for (std::size_t size = 0; size + 12 + 4 < sizeof kPng; ++size) {
    try {
      readPng(written(std::span(kPng).first(size)));
      ADD_FAILURE() << size << " bytes";
    } catch (const Error& error) {
      EXPECT_EQ(error.fault().code, FaultCode::kBadInput);
      EXPECT_NE(error.fault().file.find("read_png_test"), std::string::npos);
    }
  }
}

TEST_F(ReadPng, ChangedBytesNeverCrash) {
  for (std::size_t i = 0; i < sizeof kPng; ++i) {
    for (const unsigned change : {0x01U, 0x80U, 0xffU}) {
      std::vector<unsigned char> bytes(std::begin(kPng), std::end(kPng));
      bytes[i] = static_cast<unsigned char>(bytes[i] ^ change);
      try {
        EXPECT_LE(readPng(written(bytes)).rgba.size(), 4U * 6);
      } catch (const Error& error) {
        EXPECT_NE(error.fault().what, "");
      }
    }
  }
}

TEST_F(ReadPng, AMissingFileIsNamed) { EXPECT_THROW(readPng("no-such.png"), Error); }

}  // namespace
}  // namespace tet4d::exchange
