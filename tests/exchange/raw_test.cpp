// Raw files: every type and byte order, how many frames follow from the size, and each refusal.
#include <gtest/gtest.h>

#include <array>

#include "libpreprocess/exchange/frame_source.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::frameByLayers;
using testing::frameOf;
using testing::nativeSamples;
using testing::sampleText;
using testing::Scratch;

FrameSourceOptions rawOptions(SampleType type = SampleType::kF32, bool big_endian = false) {
  FrameSourceOptions options;
  options.file.raw = RawLayout{};
  options.file.raw->dims = {2, 3, 2};
  options.file.raw->type = type;
  options.file.raw->big_endian = big_endian;
  return options;
}

std::string messageOf(const Fault& fault) { return fault.file + ": " + fault.place + ": " + fault.what; }

void expectRefusal(const std::vector<std::string>& inputs, const FrameSourceOptions& options,
                   const std::vector<std::string>& words, FaultCode code = FaultCode::kBadInput) {
  const Fault fault = faultOf([&] { openFrames(inputs, options); });
  EXPECT_EQ(fault.code, code) << messageOf(fault);
  for (const std::string& word : words)
    EXPECT_NE(messageOf(fault).find(word), std::string::npos) << word << " in " << messageOf(fault);
}

constexpr std::array kTypes{SampleType::kU8,  SampleType::kI8,  SampleType::kU16, SampleType::kI16, SampleType::kU32,
                            SampleType::kI32, SampleType::kU64, SampleType::kI64, SampleType::kF32, SampleType::kF64};

TEST(Raw, EveryTypeAndByteOrder) {
  const Scratch scratch;
  for (const SampleType type : kTypes) {
    for (const bool big_endian : {false, true}) {
      const std::string path = scratch.write("a.raw", sampleText(type, 36, big_endian, 100));
      const auto source = openFrames({path}, rawOptions(type, big_endian));
      ASSERT_EQ(source->times(), (std::vector<double>{0, 1, 2})) << sampleName(type);
      for (const std::size_t k : {2U, 0U, 1U}) {
        EXPECT_EQ(frameOf(*source, k), nativeSamples(type, 12, 100 + 12 * k)) << sampleName(type) << big_endian;
        EXPECT_EQ(frameByLayers(*source, k), nativeSamples(type, 12, 100 + 12 * k)) << sampleName(type) << big_endian;
      }
    }
  }
}

TEST(Raw, SkippedBytesPositionsAndTimes) {
  const Scratch scratch;
  const std::string path = scratch.write("a", "header" + sampleText(SampleType::kU8, 24, false));
  FrameSourceOptions options = rawOptions(SampleType::kU8);
  options.file.raw->skip = 6;
  options.file.raw->spacing = {0.5, 2, -4};
  options.file.raw->origin = {10, 20, 30};
  options.times = {3, 3.5};
  auto source = openFrames({path}, options);
  EXPECT_EQ(source->times(), options.times);
  EXPECT_EQ(frameOf(*source, 1), nativeSamples(SampleType::kU8, 12, 12));
  EXPECT_EQ(source->grid().index_to_world.origin, (std::array<double, 3>{10, 20, 30}));
  EXPECT_EQ(source->grid().index_to_world.axes[2], (std::array<double, 3>{0, 0, -4}));
  options.file.centering = Centering::kCell;
  EXPECT_EQ(openFrames({path}, options)->grid().index_to_world.origin, (std::array<double, 3>{10.25, 21, 28}));
}

TEST(Raw, OneFrameAFileInPatternsAndDirectories) {
  const Scratch scratch;
  for (const std::uint64_t k : {8U, 9U, 10U})
    scratch.write("d/f_" + std::to_string(k) + ".raw", sampleText(SampleType::kF32, 12, false, 100 * k));
  scratch.write("d/notes.txt", "no frame");
  for (const char* input : {"d", "d/f_%d.raw"}) {
    const auto source = openFrames({scratch.path(input)}, rawOptions());
    ASSERT_EQ(source->times(), (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(frameOf(*source, 2), nativeSamples(SampleType::kF32, 12, 1000));
  }
  scratch.write("d/f_9.raw", sampleText(SampleType::kF32, 24, false));
  expectRefusal({scratch.path("d")}, rawOptions(), {"f_9.raw", "holds 2 frames", "one of 3 files"});
  scratch.write("d/x.bin", "");
  expectRefusal({scratch.path("d")}, rawOptions(), {"two kinds", "f_8.raw", "x.bin"});
}

TEST(Raw, SizesThatDoNotFitAreNamed) {
  const Scratch scratch;
  const std::string path = scratch.write("a.raw", sampleText(SampleType::kF32, 30, false));
  expectRefusal({path}, rawOptions(),
                {"a.raw", "byte 96", "2 x 3 x 2", "f32", "48 bytes", "120", "2 frames", "24 bytes"});
  FrameSourceOptions skipping = rawOptions();
  skipping.file.raw->skip = 100;
  expectRefusal({path}, skipping, {"short", "48 bytes", "holds 20 behind the 100 skipped"});
  skipping.file.raw->skip = std::numeric_limits<std::uint64_t>::max();
  expectRefusal({path}, skipping, {"short", "holds 0"});
  expectRefusal({scratch.write("empty.raw", "")}, rawOptions(), {"short", "holds 0"});
  FrameSourceOptions tiny = rawOptions(SampleType::kU8);
  tiny.file.raw->dims = {1, 1, 1};
  expectRefusal({scratch.write("many.raw", std::string((1 << 24) + 1, 'x'))}, tiny, {"16777217 frames", "16777216"});
}

TEST(Raw, LayoutsThatMakeNoSenseAreUsageErrors) {
  const Scratch scratch;
  const std::string path = scratch.write("a.raw", sampleText(SampleType::kF32, 12, false));
  const auto refused = [&](auto change, const std::string& word) {
    FrameSourceOptions options = rawOptions();
    change(*options.file.raw);
    expectRefusal({path}, options, {word}, FaultCode::kUsage);
  };
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 32;
  refused([](RawLayout& raw) { raw.dims = {2, 0, 3}; }, "a size is 0");
  refused([](RawLayout& raw) { raw.dims = {kHuge, kHuge, kHuge}; }, "2^63");
  refused([](RawLayout& raw) { raw.dims = {kHuge, kHuge / 2, 1}; }, "2^63");
  refused([](RawLayout& raw) { raw.spacing = {1, 0, 1}; }, "--spacing");
  refused([](RawLayout& raw) { raw.spacing = {1, kInf, 1}; }, "--spacing");
  refused([](RawLayout& raw) { raw.spacing = {1e-200, 1e-200, 1}; }, "--spacing");
  refused([](RawLayout& raw) { raw.origin = {1, kInf, 1}; }, "--origin");
  const std::string nrrd = scratch.write("a.nrrd", testing::smallFile());
  expectRefusal({nrrd}, rawOptions(), {"--size is for raw files", "NRRD"}, FaultCode::kUsage);
}

}  // namespace
}  // namespace tet4d::exchange
