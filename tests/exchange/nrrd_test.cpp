// What the NRRD reader reads: types, orders, encodings, layouts, positions and times.
#include <gtest/gtest.h>

#include "libpreprocess/exchange/read_nrrd.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::gzipped;
using testing::kSmallVoxels;
using testing::nativeSamples;
using testing::sampleText;
using testing::Scratch;
using testing::smallFile;
using testing::smallHeader;

std::vector<std::byte> readFrame(NrrdFile& file, std::uint64_t k = 0) {
  std::vector<std::byte> samples(static_cast<std::size_t>(file.header().frameBytes()));
  file.readFrame(k, samples);
  return samples;
}

struct Spelling {
  const char* name;
  SampleType type;
};
const Spelling kSpellings[] = {
    {"signed char", SampleType::kI8},
    {"int8", SampleType::kI8},
    {"int8_t", SampleType::kI8},
    {"uchar", SampleType::kU8},
    {"unsigned char", SampleType::kU8},
    {"uint8", SampleType::kU8},
    {"uint8_t", SampleType::kU8},
    {"short", SampleType::kI16},
    {"short int", SampleType::kI16},
    {"signed short", SampleType::kI16},
    {"signed short int", SampleType::kI16},
    {"int16", SampleType::kI16},
    {"int16_t", SampleType::kI16},
    {"ushort", SampleType::kU16},
    {"unsigned short", SampleType::kU16},
    {"unsigned short int", SampleType::kU16},
    {"uint16", SampleType::kU16},
    {"uint16_t", SampleType::kU16},
    {"int", SampleType::kI32},
    {"signed int", SampleType::kI32},
    {"int32", SampleType::kI32},
    {"int32_t", SampleType::kI32},
    {"uint", SampleType::kU32},
    {"unsigned int", SampleType::kU32},
    {"uint32", SampleType::kU32},
    {"uint32_t", SampleType::kU32},
    {"longlong", SampleType::kI64},
    {"long long", SampleType::kI64},
    {"long long int", SampleType::kI64},
    {"signed long long", SampleType::kI64},
    {"signed long long int", SampleType::kI64},
    {"int64", SampleType::kI64},
    {"int64_t", SampleType::kI64},
    {"ulonglong", SampleType::kU64},
    {"unsigned long long", SampleType::kU64},
    {"unsigned long long int", SampleType::kU64},
    {"uint64", SampleType::kU64},
    {"uint64_t", SampleType::kU64},
    {"float", SampleType::kF32},
    {"double", SampleType::kF64},
};

TEST(Nrrd, EveryTypeOrderEncodingAndLayout) {
  const Scratch scratch;
  int read = 0;
  for (const Spelling& spelling : kSpellings) {
    for (const bool big : {false, true}) {
      for (const std::string encoding : {"raw", "gzip", "gz"}) {
        for (const bool attached : {true, false}) {
          const std::string raw = sampleText(spelling.type, 12, big, 100);
          const std::string data = encoding == "raw" ? raw : gzipped(raw);
          std::string header = std::string("NRRD0005\n# a comment\ntype: ") + spelling.name +
                               "\ndimension: 3\nsizes: 2 3 2\nencoding: " + encoding +
                               "\nendian: " + (big ? "big" : "little") + "\n";
          if (!attached) header += "data file: samples.bin\n";
          scratch.write("samples.bin", data);
          NrrdFile file(scratch.write("a.nrrd", attached ? header + "\n" + data : header));
          ASSERT_EQ(file.header().grid.type, spelling.type) << spelling.name;
          ASSERT_EQ(readFrame(file), nativeSamples(spelling.type, 12, 100))
              << spelling.name << encoding << big << attached;
          ++read;
        }
      }
    }
  }
  EXPECT_EQ(read, 40 * 12);
}

TEST(Nrrd, EveryVersionAndCarriageReturns) {
  const Scratch scratch;
  for (char version = '1'; version <= '5'; ++version) {
    std::string header = smallHeader() + "content: drops: two\n";
    header[7] = version;
    NrrdFile plain(scratch.write("a.nrrd", header + "\n" + sampleText(SampleType::kF32, 12, false)));
    EXPECT_EQ(readFrame(plain), nativeSamples(SampleType::kF32, 12));
    std::string returns;
    for (const char c : header + "\n") returns += c == '\n' ? std::string("\r\n") : std::string(1, c);
    NrrdFile windows(scratch.write("b.nrrd", returns + sampleText(SampleType::kF32, 12, false)));
    EXPECT_EQ(readFrame(windows), nativeSamples(SampleType::kF32, 12));
  }
}

TEST(Nrrd, OneByteSamplesNeedNoEndian) {
  const Scratch scratch;
  NrrdFile file(scratch.write("a.nrrd", "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 1 1 3\nencoding: raw\n\nabc"));
  EXPECT_EQ(readFrame(file), nativeSamples(SampleType::kU8, 3, 'a'));
}

TEST(Nrrd, DataFilesByListPatternAndParts) {
  const Scratch scratch;
  const std::string raw = sampleText(SampleType::kF32, 24, false);
  const std::string header = "NRRD0004\ntype: float\ndimension: 4\nsizes: 2 3 2 2\nendian: little\nencoding: ";
  const auto expect = [&](const std::string& text) {
    NrrdFile file(scratch.write("sub/a.nhdr", text));
    ASSERT_EQ(file.header().frames, 2u);
    EXPECT_EQ(readFrame(file, 1), nativeSamples(SampleType::kF32, 12, 12)) << text;
    EXPECT_EQ(readFrame(file, 0), nativeSamples(SampleType::kF32, 12, 0)) << text;
  };
  for (const bool gzip : {false, true}) {
    const auto part = [&](const std::string& name, std::size_t begin, std::size_t count) {
      const std::string text = raw.substr(begin * 4, count * 4);
      scratch.write("sub/" + name, gzip ? gzipped(text) : text);
    };
    part("first", 0, 12), part("second part.raw", 12, 12);
    part("f_07.raw", 0, 12), part("f_09.raw", 12, 12);
    part("s_3.raw", 0, 6), part("s_2.raw", 6, 6), part("s_1.raw", 12, 6), part("s_0.raw", 18, 6);
    part("all", 0, 24);
    const std::string with_encoding = header + (gzip ? "gzip\n" : "raw\n");
    expect(with_encoding + "data file: LIST\nfirst\nsecond part.raw\n");
    expect(with_encoding + "datafile: LIST 4\nfirst\nsecond part.raw\n");
    expect(with_encoding + "data file: f_%02d.raw 7 9 2\n");
    expect(with_encoding + "data file: f_%02d.raw 7 10 2 3\n");
    expect(with_encoding + "data file: s_%d.raw 3 0 -1 2\n");  // a file a plane, counted down
    expect(with_encoding + "data file: all\n");
    expect(with_encoding + "data file: " + scratch.path("sub/all") + "\n");
  }
}

TEST(Nrrd, SkipsLinesBeforeAndBytesAfterDecoding) {
  const Scratch scratch;
  const std::string raw = sampleText(SampleType::kF32, 12, false);
  const auto expect = [&](const std::string& text) {
    NrrdFile file(scratch.write("a.nhdr", text));
    EXPECT_EQ(readFrame(file), nativeSamples(SampleType::kF32, 12)) << text;
  };
  scratch.write("d", "one\ntwo\nxyz" + raw);
  expect(smallHeader() + "data file: d\nline skip: 2\nbyte skip: 3\n");
  expect(smallHeader() + "data file: d\nlineskip: 1\nbyteskip: 7\n");
  expect(smallHeader() + "data file: d\nbyte skip: -1\n");
  expect(smallHeader() + "byte skip: 3\n\nxyz" + raw);
  scratch.write("z", "one\n" + gzipped("xyz" + raw));
  expect(smallHeader("gzip") + "data file: z\nline skip: 1\nbyte skip: 3\n");
  // A longer raw data file is legal when detached: several headers may share it.
  scratch.write("long", raw + raw);
  expect(smallHeader() + "data file: long\n");
}

TEST(Nrrd, GzipOfSeveralMembersAndBackwardReads) {
  const Scratch scratch;
  std::string data;
  for (int k = 0; k < 5; ++k)
    data += gzipped(sampleText(SampleType::kI16, 12, true, static_cast<std::uint64_t>(12 * k)));
  NrrdFile file(scratch.write(
      "a.nrrd", "NRRD0004\ntype: short\ndimension: 4\nsizes: 3 2 2 5\nencoding: gzip\nendian: big\n\n" + data));
  for (const std::uint64_t k : {0u, 1u, 4u, 4u, 2u, 3u, 0u}) {
    EXPECT_EQ(readFrame(file, k), nativeSamples(SampleType::kI16, 12, 12 * k)) << k;
  }
}

TEST(Nrrd, NodeAndCellCentredAxes) {
  const Scratch scratch;
  const auto gridOf = [&](const std::string& lines) {
    return NrrdFile(scratch.write("a.nrrd", smallHeader() + lines + "\n" + sampleText(SampleType::kF32, 12, false)))
        .header()
        .grid;
  };
  const GridInfo plain = gridOf("");
  EXPECT_EQ(plain.dims, (std::array<std::uint64_t, 3>{2, 3, 2}));
  EXPECT_EQ(plain.index_to_world, AffineMap{});
  const GridInfo cells = gridOf("spacings: 0.5 2 4\naxis mins: 10 20 -30\ncenters: cell node cell\n");
  EXPECT_EQ(cells.index_to_world.origin, (std::array<double, 3>{10.25, 20, -28}));
  EXPECT_EQ(cells.index_to_world.axes[1], (std::array<double, 3>{0, 2, 0}));
  const GridInfo extents = gridOf("axismins: 0 0 0\naxismaxs: 1 6 1\ncenterings: node cell none\n");
  EXPECT_EQ(extents.index_to_world.origin, (std::array<double, 3>{0, 1, 0}));
  EXPECT_EQ(extents.index_to_world.axes[0][0], 1);
  EXPECT_EQ(extents.index_to_world.axes[1][1], 2);
  const GridInfo from_max = gridOf("spacings: 1 1 1\naxis maxs: 5 5 5\ncenters: node node cell\n");
  EXPECT_EQ(from_max.index_to_world.origin, (std::array<double, 3>{4, 3, 3.5}));
  const GridInfo negative = gridOf("spacings: -1 1 1\n");
  EXPECT_LT(cellVolume(negative.index_to_world), 0);
}

TEST(Nrrd, SpaceDirectionsPutTheOriginOnTheFirstSample) {
  const Scratch scratch;
  NrrdFile file(
      scratch.write("a.nrrd", smallHeader() +
                                  "space: left-posterior-superior\nspace directions: (0, 2,0) (-3,0,0)(0,0,0.5)\n"
                                  "space origin: (1e6, -5, 7)\ncenters: cell cell cell\n\n" +
                                  sampleText(SampleType::kF32, 12, false)));
  const AffineMap& map = file.header().grid.index_to_world;
  EXPECT_EQ(map.origin, (std::array<double, 3>{1e6, -5, 7}));
  EXPECT_EQ(map.axes[0], (std::array<double, 3>{0, 2, 0}));
  EXPECT_EQ(map.axes[1], (std::array<double, 3>{-3, 0, 0}));
  EXPECT_EQ(map.axes[2], (std::array<double, 3>{0, 0, 0.5}));
}

std::string fourD(const std::string& lines) {
  return "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 2 2 3\nencoding: raw\n" + lines + "\n" + std::string(12, 'x');
}

TEST(Nrrd, TimesOfFourDimensions) {
  const Scratch scratch;
  const auto timesOf = [&](const std::string& lines) {
    return NrrdFile(scratch.write("a.nrrd", fourD(lines))).header().times;
  };
  using Times = std::vector<double>;
  EXPECT_EQ(timesOf(""), Times{});
  EXPECT_EQ(timesOf("spacings: 1 1 1 nan\n"), Times{});
  EXPECT_EQ(timesOf("spacings: 1 1 1 0.5\n"), (Times{0, 0.5, 1}));
  EXPECT_EQ(timesOf("spacings: 1 1 1 0.5\naxis mins: 0 0 0 7\n"), (Times{7, 7.5, 8}));
  EXPECT_EQ(timesOf("axis mins: 0 0 0 7\naxis maxs: 0 1 1 8\n"), (Times{7, 7.5, 8}));
  EXPECT_EQ(timesOf("space directions: (1,0,0) (0,1,0) (0,0,1) none\nspacings: nan nan nan 2\n"), (Times{0, 2, 4}));
  EXPECT_EQ(timesOf("space directions: (1,0,0) (0,1,0) (0,0,1) none\n"), Times{});
  EXPECT_EQ(timesOf("space dimension: 4\nspace directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,0.25)\n"
                    "space origin: (9,9,9,100)\n"),
            (Times{100, 100.25, 100.5}));
  EXPECT_EQ(timesOf("spacings: 1 1 1 5\ntimes:=1 2.5 1e3\n"), (Times{1, 2.5, 1000}));
}

TEST(Nrrd, AScalarAxisInFrontIsNoSpace) {
  const Scratch scratch;
  const std::string twelve(12, 'x');
  const NrrdFile one(scratch.write("a.nrrd",
                                   "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 2 2 3\nencoding: raw\n"
                                   "kinds: scalar domain domain domain\nspacings: nan 4 5 6\n\n" +
                                       twelve));
  EXPECT_EQ(one.header().grid.dims, (std::array<std::uint64_t, 3>{2, 2, 3}));
  EXPECT_FALSE(one.header().has_frame_axis);
  EXPECT_EQ(one.header().grid.index_to_world.axes[2][2], 6);
  const NrrdFile five(
      scratch.write("b.nrrd", "NRRD0004\ntype: uchar\ndimension: 5\nsizes: 1 2 2 1 3\nencoding: raw\n\n" + twelve));
  EXPECT_EQ(five.header().grid.dims, (std::array<std::uint64_t, 3>{2, 2, 1}));
  EXPECT_EQ(five.header().frames, 3u);
}

TEST(Nrrd, TheCallersCenteringIsForHeadersThatTellNone) {
  const Scratch scratch;
  const auto originOf = [&](const std::string& lines, Centering centering) {
    FrameFileOptions options;
    options.centering = centering;
    const std::string text = smallHeader() + lines + "\n" + sampleText(SampleType::kF32, 12, false);
    return NrrdFile(scratch.write("a.nrrd", text), options).header().grid.index_to_world.origin;
  };
  using Origin = std::array<double, 3>;
  const std::string spaced = "spacings: 2 4 8\naxis mins: 1 1 1\n";
  EXPECT_EQ(originOf(spaced, Centering::kUntold), (Origin{1, 1, 1}));
  EXPECT_EQ(originOf(spaced, Centering::kNode), (Origin{1, 1, 1}));
  EXPECT_EQ(originOf(spaced, Centering::kCell), (Origin{2, 3, 5}));
  EXPECT_EQ(originOf(spaced + "centerings: node ??? none\n", Centering::kCell), (Origin{1, 3, 5}));
  EXPECT_EQ(originOf(spaced + "centerings: cell cell cell\n", Centering::kNode), (Origin{2, 3, 5}));
  const std::string directed = "space directions: (2,0,0) (0,4,0) (0,0,8)\nspace origin: (1,1,1)\n";
  EXPECT_EQ(originOf(directed, Centering::kCell), (Origin{1, 1, 1})) << "the origin is the first sample";
}

TEST(Nrrd, KeysAndTheirEscapes) {
  const Scratch scratch;
  const std::string path = scratch.write("a.nrrd", smallFile("note:=a: b\\nc\\\\\ntime:= 0.125\n"));
  EXPECT_EQ(NrrdFile(path).header().times, std::vector<double>{0.125});
  const InputFile text(path);
  ByteStream bytes(text);
  const NrrdFields fields = readNrrdFields(bytes, path);
  EXPECT_EQ(fields.key_values.at("note"), "a: b\nc\\");
}

}  // namespace
}  // namespace tet4d::exchange
