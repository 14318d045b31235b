// Sequences of frames by name: what is accepted, in which order and with which times, and each refusal.
#include <gtest/gtest.h>

#include <filesystem>

#include "libpreprocess/exchange/file_series.h"
#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/exchange/printf_pattern.h"
#include "libpreprocess/exchange/write_frames.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::frameByLayers;
using testing::frameOf;
using testing::gzipped;
using testing::nativeSamples;
using testing::sampleText;
using testing::Scratch;
using testing::smallFile;
using testing::smallHeader;
using Times = std::vector<double>;

// Frame k's samples begin with k * 100.
std::string frameFile(std::uint64_t k, const std::string& time_line = "") { return smallFile(time_line, 100 * k); }

std::vector<std::byte> expectedFrame(std::uint64_t k) { return nativeSamples(SampleType::kF32, 12, 100 * k); }

void expectFrames(FrameSource& source, const std::vector<std::uint64_t>& frames, const Times& times) {
  EXPECT_EQ(source.times(), times);
  ASSERT_EQ(source.times().size(), frames.size());
  EXPECT_FALSE(source.isStream());
  EXPECT_TRUE(source.hasFrame(frames.size() - 1));
  EXPECT_FALSE(source.hasFrame(frames.size()));
  for (std::size_t k = frames.size(); k-- > 0;) EXPECT_EQ(frameOf(source, k), expectedFrame(frames[k])) << k;
  for (std::size_t k = 0; k < frames.size(); ++k) EXPECT_EQ(frameByLayers(source, k), expectedFrame(frames[k])) << k;
}

std::string messageOf(const Fault& fault) {
  return fault.file + ": " + fault.place + ": " + fault.what + "; " + fault.remedy;
}

// The message of a refused list must hold all the words.
void expectRefusal(const std::vector<std::string>& inputs, const std::vector<std::string>& words,
                   FaultCode code = FaultCode::kBadInput) {
  const Fault fault = faultOf([&] { openFrames(inputs); });
  EXPECT_EQ(fault.code, code) << messageOf(fault);
  for (const std::string& word : words)
    EXPECT_NE(messageOf(fault).find(word), std::string::npos) << word << " in " << messageOf(fault);
}

TEST(OpenFrames, ListsKeepTheirOrderAndCountTheirTimes) {
  const Scratch scratch;
  const std::string a = scratch.write("drop.nrrd", frameFile(4)), b = scratch.write("crown.nrrd", frameFile(7));
  const auto source = openFrames({a, b});
  EXPECT_EQ(source->grid().dims, (std::array<std::uint64_t, 3>{2, 3, 2}));
  EXPECT_EQ(source->frameName(1), b);
  expectFrames(*source, {4, 7}, {0, 1});
}

TEST(OpenFrames, DirectoriesAndPatternsAreInNaturalOrder) {
  const Scratch scratch;
  for (const int k : {8, 9, 10, 11})
    scratch.write("run/f" + std::to_string(k) + ".nrrd", frameFile(static_cast<std::uint64_t>(k)));
  scratch.write("run/notes.txt", "no frame");
  const auto directory = openFrames({scratch.path("run")});
  expectFrames(*directory, {8, 9, 10, 11}, {0, 1, 2, 3});
  const auto pattern = openFrames({scratch.path("run/f%d.nrrd")});
  expectFrames(*pattern, {8, 9, 10, 11}, {0, 1, 2, 3});
  scratch.write("padded/a_0008.nhdr", frameFile(8)), scratch.write("padded/a_0010.nhdr", frameFile(10));
  scratch.write("padded/a_9.nhdr", "is not of the pattern");
  expectFrames(*openFrames({scratch.path("padded/a_%04d.nhdr")}), {8, 10}, {0, 1});
}

TEST(OpenFrames, LayersInTheMiddleAlone) {
  const Scratch scratch;
  const std::string header = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 1 5 2\nencoding: ";
  const std::string samples = sampleText(SampleType::kU8, 20, false);
  for (const std::string& text : {header + "raw\n\n" + samples, header + "gzip\n\n" + gzipped(samples)}) {
    const auto source = openFrames({scratch.write("a.nrrd", text)});
    std::vector<std::byte> two(4), one(2);
    for (const std::size_t k : {1U, 0U}) {  // back to a frame before: a compressed stream begins anew
      source->readLayers(k, 1, 3, two);
      EXPECT_EQ(two, nativeSamples(SampleType::kU8, 4, 10 * k + 2));
      source->readLayers(k, 4, 5, one);
      EXPECT_EQ(one, nativeSamples(SampleType::kU8, 2, 10 * k + 8));
    }
  }
}

TEST(OpenFrames, FilesWithoutASuffixAreKnownByTheirFirstBytes) {
  const Scratch scratch;
  const std::string a = scratch.write("volume", frameFile(3));
  expectFrames(*openFrames({a}), {3}, {0});
  expectRefusal({scratch.write("letter", "Dear all")}, {"letter", "first bytes", ".nrrd"});
  expectRefusal({scratch.write("nothing", "")}, {"nothing", "first bytes"});
}

TEST(OpenFrames, TimesOfTheFilesAndOfTheCaller) {
  const Scratch scratch;
  const std::string a = scratch.write("a_0.nrrd", frameFile(0, "time:=1600000000.5\n"));
  const std::string b = scratch.write("a_13.nrrd", frameFile(1, "time:=1600000000.75\n"));
  const std::string c = scratch.write("a_31.nrrd", frameFile(2, "time:=1600000002\n"));  // a solver's step numbers
  expectFrames(*openFrames({a, b, c}), {0, 1, 2}, {1600000000.5, 1600000000.75, 1600000002});
  FrameSourceOptions options;
  options.times = {5, 6, 7.5};
  expectFrames(*openFrames({a, b, c}, options), {0, 1, 2}, {5, 6, 7.5});
  options.times = {5, 6};
  EXPECT_NE(faultOf([&] {
              openFrames({a, b, c}, options);
            }).what.find("2 times are given for 3 frames"),
            std::string::npos);
  options.times = {5, 5, 6};
  EXPECT_EQ(faultOf([&] { openFrames({a, b, c}, options); }).code, FaultCode::kUsage);
}

TEST(OpenFrames, OneFourDimensionalFile) {
  const Scratch scratch;
  std::string samples;
  for (std::uint64_t k = 0; k < 3; ++k) samples += sampleText(SampleType::kF32, 12, false, 100 * k);
  const std::string header =
      "NRRD0004\ntype: float\ndimension: 4\nsizes: 2 3 2 3\nendian: little\nspacings: 1 1 1 0.25\nencoding: ";
  expectFrames(*openFrames({scratch.write("raw.nrrd", header + "raw\n\n" + samples)}), {0, 1, 2}, {0, 0.25, 0.5});
  const std::string gzip = scratch.write("gz.nrrd", header + "gzip\n\n" + gzipped(samples));
  const auto source = openFrames({gzip});
  expectFrames(*source, {0, 1, 2}, {0, 0.25, 0.5});
  EXPECT_EQ(source->frameName(2), gzip + " frame 2");
  expectRefusal({gzip, gzip}, {gzip, "holds 3 frames", "2 files"});
}

TEST(OpenFrames, GridFilesRoundTripThroughNrrd) {
  const Scratch scratch;
  outofcore::Progress progress;
  const std::string lines =
      "space directions: (0,0.1,0) (-0.3,0,0) (0,0,1e-3)\nspace dimension: 3\nspace origin: (1e7,0.1,-3)\n";
  const std::string a = scratch.write("a.nrrd", frameFile(0, lines + "time:=0.1\n"));
  const std::string b = scratch.write("b.nrrd", frameFile(5, lines + "time:=0.30000000000000004\n"));
  const std::string c = scratch.write("c.nrrd", frameFile(6, lines + "time:=7\n"));
  const auto frames = openFrames({a, b, c});
  for (const bool zstd : {false, true}) {
    if (zstd && !paged::hasCodec(paged::Codec::kZstd)) continue;
    const std::string grid = scratch.path("x.t4g"), nrrd = scratch.path("x.nrrd");
    std::uint64_t digest = 0;
    const auto provenance = [&](std::uint64_t samples_digest) { return digest = samples_digest, std::string("{}"); };
    writeGrid4(grid, *frames, zstd ? paged::Codec::kZstd : paged::Codec::kRaw, true, provenance, progress);
    const auto from_grid = openFrames({grid});
    EXPECT_EQ(from_grid->grid().index_to_world, frames->grid().index_to_world);
    expectFrames(*from_grid, {0, 5, 6}, {0.1, 0.30000000000000004, 7});
    writeNrrd(nrrd, *from_grid, true, progress);
    const auto from_nrrd = openFrames({nrrd});
    EXPECT_EQ(from_nrrd->grid().index_to_world, frames->grid().index_to_world);
    EXPECT_EQ(from_nrrd->grid().type, SampleType::kF32);
    expectFrames(*from_nrrd, {0, 5, 6}, {0.1, 0.30000000000000004, 7});
    const std::uint64_t first_digest = digest;
    writeGrid4(scratch.path("y.t4g"), *from_nrrd, paged::Codec::kRaw, true, provenance, progress);
    EXPECT_EQ(digest, first_digest) << "the digest is of the samples, not of the files";
    EXPECT_EQ(faultOf([&] { writeNrrd(nrrd, *from_grid, false, progress); }).code, FaultCode::kIo)
        << "kept without force";
  }
}

TEST(OpenFramesRefusals, MissingFile) {
  const Scratch scratch;
  const std::string a = scratch.write("a_0.nrrd", frameFile(0)), gone = scratch.path("a_1.nrrd");
  expectRefusal({a, gone}, {gone, "cannot be opened", "No such file"}, FaultCode::kIo);
  expectRefusal({gone}, {gone, "cannot be opened"}, FaultCode::kIo);
  expectRefusal({scratch.path("b_%d.nrrd")}, {"b_%d.nrrd", "no file has such a name"});
  std::filesystem::create_directory(scratch.path("empty"));
  expectRefusal({scratch.path("empty")}, {"empty", "holds no .nrrd"});
  expectRefusal({}, {"no frames"}, FaultCode::kUsage);
}

TEST(OpenFramesRefusals, HoleInTheNumbering) {
  const Scratch scratch;
  for (const int k : {0, 10, 20, 40, 50})
    scratch.write("r/f_" + std::to_string(k) + ".nrrd", frameFile(static_cast<std::uint64_t>(k)));
  expectRefusal({scratch.path("r")},
                {"frame number 30 is missing", "f_20.nrrd", "f_40.nrrd", "10 apart", "--allow-gaps"});
  expectRefusal({scratch.path("r/f_%d.nrrd")}, {"frame number 30 is missing"});
  FrameSourceOptions options;
  options.allow_gaps = true;
  expectFrames(*openFrames({scratch.path("r")}, options), {0, 10, 20, 40, 50}, {0, 1, 2, 4, 5});
  for (const int k : {0, 1, 3})
    scratch.write("t/f_" + std::to_string(k) + ".nrrd", frameFile(0, "time:=" + std::to_string(k) + "\n"));
  expectRefusal({scratch.path("t")}, {"frame number 2 is missing"});
  EXPECT_EQ(openFrames({scratch.path("t")}, options)->times(), (Times{0, 1, 3}));
  for (const int k : {0, 2, 5}) scratch.write("u/f_" + std::to_string(k) + ".nrrd", frameFile(0));
  expectRefusal({scratch.path("u")}, {"no common step"});
}

TEST(OpenFramesRefusals, ShortFile) {
  const Scratch scratch;
  const std::string a = scratch.write("a_0.nrrd", frameFile(0));
  std::string text = frameFile(1);
  text.resize(text.size() - 5);
  const std::string b = scratch.write("a_1.nrrd", text);
  expectRefusal({a, b}, {b, "short", "43 bytes", "48"});
}

TEST(OpenFramesRefusals, AnotherSizeTypeOrSpacing) {
  const Scratch scratch;
  const std::string a = scratch.write("a_0.nrrd", frameFile(0));
  const auto other = [&](const std::string& header) {
    return scratch.write("a_1.nrrd", header + "\n" + sampleText(SampleType::kF32, 12, false));
  };
  const std::string size = "NRRD0004\ntype: float\ndimension: 3\nsizes: 3 2 2\nencoding: raw\nendian: little\n";
  expectRefusal({a, other(size)}, {"a_1.nrrd", "3 x 2 x 2", "2 x 3 x 2", "a_0.nrrd"});
  const std::string type = "NRRD0004\ntype: int\ndimension: 3\nsizes: 2 3 2\nencoding: raw\nendian: little\n";
  expectRefusal({a, other(type)}, {"a_1.nrrd", "i32", "f32", "a_0.nrrd"});
  expectRefusal({a, other(smallHeader() + "spacings: 1 1 1.1\n")}, {"a_1.nrrd", "spacing", "a_0.nrrd"});
  expectRefusal({a, other(smallHeader() + "axis mins: 0 0 5\n")}, {"a_1.nrrd", "origin", "a_0.nrrd"});
  // Digits lost in a decimal text are no other grid.
  EXPECT_EQ(openFrames({a, other(smallHeader() + "spacings: 1 1 1.0000001\n")})->times().size(), 2u);
}

TEST(OpenFramesRefusals, OutOfTimeOrder) {
  const Scratch scratch;
  const std::string a = scratch.write("a.nrrd", frameFile(0, "time:=2.5\n")),
                    b = scratch.write("b.nrrd", frameFile(1, "time:=2e-7\n"));
  expectRefusal({a, b}, {a, b, "2.5", "2e-07"});
  expectRefusal({a, a}, {"2.5"});
  const std::string c = scratch.write("f_2.nrrd", frameFile(0)), d = scratch.write("f_10.nrrd", frameFile(1));
  expectRefusal({d, c}, {c, d, "number 2 comes after number 10"});  // as a shell sorts names
}

TEST(OpenFramesRefusals, TimesOfSomeFilesOnly) {
  const Scratch scratch;
  const std::string a = scratch.write("a.nrrd", frameFile(0, "time:=0\n")), b = scratch.write("b.nrrd", frameFile(1));
  expectRefusal({a, b}, {a, b, "tells no time"});
  expectRefusal({b, a}, {a, b, "tells no time"});
}

TEST(OpenFramesRefusals, FramesThatGetShortAfterOpening) {
  const Scratch scratch;
  const std::string a = scratch.write("a_0.nrrd", frameFile(0)), b = scratch.write("a_1.nrrd", frameFile(1));
  const auto source = openFrames({a, b});
  scratch.write("a_1.nrrd", smallHeader() + "\nabc");
  const Fault fault = faultOf([&] { frameOf(*source, 1); });
  EXPECT_EQ(fault.file, b);
  EXPECT_TRUE(fault.place.starts_with("byte "));
  EXPECT_EQ(frameOf(*source, 0), expectedFrame(0));
}

TEST(FileSeries, NaturalOrder) {
  const std::vector<std::string> sorted{"a", "a1", "a01", "a2", "a10", "a10b", "a100", "b0"};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for (std::size_t j = 0; j < sorted.size(); ++j) {
      const bool same_number = (i == 1 && j == 2) || (i == 2 && j == 1);
      if (same_number) continue;
      EXPECT_EQ(naturalLess(sorted[i], sorted[j]), i < j) << sorted[i] << " " << sorted[j];
    }
  }
  EXPECT_NE(naturalLess("a1", "a01"), naturalLess("a01", "a1"));
}

TEST(FileSeries, Patterns) {
  const auto pattern = NumberPattern::parse("x%%_%04d.nrrd");
  ASSERT_TRUE(pattern);
  EXPECT_EQ(pattern->name(7), "x%_0007.nrrd");
  EXPECT_EQ(pattern->name(123456), "x%_123456.nrrd");
  EXPECT_EQ(pattern->name(-7), "x%_-007.nrrd");
  EXPECT_EQ(pattern->numberOf("x%_0007.nrrd"), 7);
  EXPECT_EQ(pattern->numberOf("x%_007.nrrd"), std::nullopt);
  EXPECT_EQ(pattern->numberOf("x%_.nrrd"), std::nullopt);
  EXPECT_EQ(NumberPattern::parse("a%3i")->name(5), "a  5");
  for (const char* none : {"a", "a%", "a%s", "a%d%d", "a%99d", "a%-4d", "a%lu"})
    EXPECT_FALSE(NumberPattern::parse(none)) << none;
}

}  // namespace
}  // namespace tet4d::exchange
