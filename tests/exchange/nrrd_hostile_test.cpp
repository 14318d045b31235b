// What the NRRD reader refuses, and that it refuses cleanly: every prefix, every changed byte, every number out of
// range.
#include <gtest/gtest.h>

#include "libpreprocess/exchange/read_nrrd.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::gzipped;
using testing::nativeSamples;
using testing::sampleText;
using testing::Scratch;
using testing::smallFile;
using testing::smallHeader;

std::vector<std::byte> readAll(const std::string& path) {
  NrrdFile file(path);
  std::vector<std::byte> samples(static_cast<std::size_t>(file.header().frameBytes()));
  for (std::uint64_t k = 0; k < file.header().frames; ++k) file.readFrame(k, samples);
  return samples;
}

std::string smallGzip() { return smallHeader("gzip") + "\n" + gzipped(sampleText(SampleType::kF32, 12, false)); }

TEST(NrrdHostile, EveryPrefixIsAnErrorThatNamesTheFile) {
  const Scratch scratch;
  for (const std::string& whole : {smallFile("time:=1\n"), smallGzip()}) {
    ASSERT_EQ(readAll(scratch.write("a.nrrd", whole)), nativeSamples(SampleType::kF32, 12));
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const std::string path = scratch.write("a.nrrd", std::string_view(whole).substr(0, length));
      const Fault fault = faultOf([&] { readAll(path); });
      ASSERT_EQ(fault.code, FaultCode::kBadInput) << length;
      ASSERT_EQ(fault.file, path) << length;
      ASSERT_FALSE(fault.place.empty()) << length;
    }
  }
}

TEST(NrrdHostile, EveryPrefixOfADetachedGzipIsAnError) {
  const Scratch scratch;
  const std::string data = gzipped(sampleText(SampleType::kF32, 12, false));
  const std::string header = scratch.write("a.nhdr", smallHeader("gzip") + "data file: d.gz\n");
  for (std::size_t length = 0; length < data.size(); ++length) {
    scratch.write("d.gz", std::string_view(data).substr(0, length));
    const Fault fault = faultOf([&] { readAll(header); });
    ASSERT_EQ(fault.file, scratch.path("d.gz"));
    ASSERT_TRUE(fault.place.starts_with("byte ")) << fault.place;
    ASSERT_LE(std::stoull(fault.place.substr(5)), length);
  }
}

TEST(NrrdHostile, ChangedBytesGiveErrorsOrTheSameSamples) {
  const Scratch scratch;
  const std::string whole = smallGzip();
  const std::size_t data_at = smallHeader("gzip").size() + 1;
  int refused = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char flip : {'\x01', '\x80', '\xff'}) {
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ flip);
      const std::string path = scratch.write("a.nrrd", changed);
      try {
        const auto samples = readAll(path);
        // In the stream only gzip's own time, flags and system bytes do not matter; a changed header may mean another
        // grid.
        if (i < data_at) continue;
        ASSERT_EQ(samples, nativeSamples(SampleType::kF32, 12)) << i;
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 200);
}

TEST(NrrdHostile, WrongChecksumNamesFileAndByte) {
  const Scratch scratch;
  std::string data = gzipped(sampleText(SampleType::kF32, 12, false));
  data[data.size() - 6] = static_cast<char>(data[data.size() - 6] ^ 1);  // CRC-32 stands in the last 8 bytes but 4
  scratch.write("d.gz", data);
  const std::string header = scratch.write("a.nhdr", smallHeader("gzip") + "data file: d.gz\n");
  const Fault fault = faultOf([&] { readAll(header); });
  EXPECT_EQ(fault.file, scratch.path("d.gz"));
  EXPECT_TRUE(fault.place.starts_with("byte "));
  EXPECT_NE(fault.what.find("incorrect data check"), std::string::npos) << fault.what;
}

TEST(NrrdHostile, AfterAFaultTheFileIsReadAgain) {
  const Scratch scratch;
  const std::string good = gzipped(sampleText(SampleType::kF32, 12, false));
  scratch.write("d.gz", good.substr(0, good.size() - 1));
  NrrdFile file(scratch.write("a.nhdr", smallHeader("gzip") + "data file: d.gz\n"));
  std::vector<std::byte> samples(48);
  faultOf([&] { file.readFrame(0, samples); });
  scratch.write("d.gz", good);
  file.readFrame(0, samples);
  EXPECT_EQ(samples, nativeSamples(SampleType::kF32, 12));
}

struct Refusal {
  std::string header;  // whole header but the empty line; 48 bytes of samples follow
  std::string words;   // what the message must hold
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(NrrdHostile, EachBadHeaderIsNamed) {
  const std::string good = smallHeader();
  const auto with = [&](const std::string& from, const std::string& to) { return replaced(good, from, to); };
  const std::string four = with("dimension: 3\nsizes: 2 3 2", "dimension: 4\nsizes: 1 2 2 3");
  const std::vector<Refusal> refusals{
      {with("NRRD0004", "NRRD0006"), "NRRD0001"},
      {with("NRRD0004", "P5"), "NRRD0001"},
      {with("type: float", "type: block"), "opaque"},
      {with("type: float", "type: half"), "unknown"},
      {with("type: float\n", ""), "\"type\" is missing"},
      {with("encoding: raw", "encoding: bzip2"), "bzip2"},
      {with("encoding: raw", "encoding: hex"), "hex"},
      {with("encoding: raw", "encoding: ascii"), "ascii"},
      {with("encoding: raw", "encoding: txt"), "txt"},
      {with("encoding: raw\n", ""), "\"encoding\" is missing"},
      {with("endian: little\n", ""), "\"endian\" is missing"},
      {with("endian: little", "endian: middle"), "middle"},
      {with("dimension: 3", "dimension: 2"), "expected 3"},
      {with("dimension: 3", "dimension: 99999999999999999999"), "dimension"},
      {with("dimension: 3", "dimension: -3"), "dimension"},
      {with("dimension: 3\n", ""), "\"dimension\" is missing"},
      {with("sizes: 2 3 2", "sizes: 2 3"), "2 entries"},
      {with("sizes: 2 3 2", "sizes: 2 0 2"), "from 1 on"},
      {with("sizes: 2 3 2", "sizes: 2 -3 2"), "from 1 on"},
      {with("sizes: 2 3 2", "sizes: 2 3.5 2"), "from 1 on"},
      {with("sizes: 2 3 2", "sizes: 4294967296 4294967296 4294967296"), "2^63"},
      {with("sizes: 2 3 2", "sizes: 2305843009213693952 2 1"), "2^63"},
      {with("sizes: 2 3 2", "sizes: 1000000 1000000 1000"), "short"},
      {with("sizes: 2 3 2", "sizes: 2 3 3"), "short: it holds 48 bytes"},
      {with("sizes: 2 3 2", "sizes: 2 2 2"), "goes on for 16 bytes"},
      {good + "spacings: 1 nan 1\n", "\"spacings\" of axis 1"},
      {good + "spacings: 1 0 1\n", "not 0"},
      {good + "spacings: 1 inf 1\n", "finite"},
      {good + "spacings: 1 1e999 1\n", "no number"},
      {good + "spacings: 1 1mm 1\n", "1mm"},
      {good + "spacings: 1 1\n", "2 entries"},
      {good + "axis mins: 0 nan 0\n", "\"axis mins\" of axis 1"},
      {good + "axis mins: 1 1 1\naxis maxs: 1 2 2\n", "lie in a plane"},
      {good + "centers: cell cell corner\n", "corner"},
      {good + "space directions: (1,0,0) (0,1,0) (0,0,x)\n", "no vector"},
      {good + "space directions: (1,0,0) (0,1,0) (1,1,0)\n", "plane"},
      {good + "space directions: (1,0,0) (0,1,0) none\n", "no direction"},
      {good + "space directions: (1,0) (0,1) (1,1)\n", "expected 3"},
      {good + "space directions: (1,0,0,1) (0,1,0,0) (0,0,1,0)\n", "space and time"},
      {good + "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0)\n", "vector of 3"},
      {good + "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,inf)\n", "finite"},
      {good + "space directions: (1,0,0) (0,1,0) (0,0,1)\nspacings: 1 1 1\n", "direction and a spacing"},
      {good + "byte skip: -2\n", "\"-2\" is no count"},
      {good + "byte skip: 9223372036854775807\n", "short"},
      {good + "byte skip: 9223372036854775808\n", "count of bytes"},
      {with("raw", "gzip") + "byte skip: -1\n", "raw data only"},
      {good + "line skip: 1000\n", "line skip"},
      {good + "line skip: -1\n", "count of lines"},
      {good + "type: float\n", "given twice"},
      {good + "endian : big\n", "no field"},
      {good + "spacing: 1 1 1\n", "no field of NRRD"},
      {good + "nonsense\n", "nonsense"},
      {good + "time:=\n", "key time"},
      {good + "time:=noon\n", "noon"},
      {good + "time:=nan\n", "nan"},
      {good + "time:=1\ntime:=2\n", "given twice"},
      {good + "data file: LIST x\n", "LIST"},
      {good + "data file: LIST\n", "1 data files, but the sizes ask for 2"},
      {good + "data file: d_%d 0 3\n", "cannot be opened"},
      {good + "data file: d_%s 0 1 1\n", "PATTERN"},
      {good + "data file: d_%d 0 1 0\n", "PATTERN"},
      {good + "data file: d_%d 0 1 -1\n", "PATTERN"},
      {good + "data file: d_%d 0 9223372036854775807 1\n", "PATTERN"},
      {good + "data file: d_%d 0 100000000000 1\n", "100000000001 data files"},
      {good + "data file: d_%d 0 1 1 9\n", "subdimension"},
      {good + "data file: d_%d%d 0 1 1\n", "PATTERN"},
      {good + "data file: gone.raw\n", "cannot be opened"},
      {good + "data file: .\n", "regular file"},
      {four + "spacings: 1 1 1 -1\n", "frame 1"},
      {four + "spacings: 1 1 1 0\n", "frame 1"},
      {four + "times:=1 2\n", "2 times"},
      {four + "times:=1 1 2\n", "frame 1"},
      {four + "times:=1 2 inf\n", "inf"},
      {with("dimension: 3\nsizes: 2 3 2", "dimension: 4\nsizes: 3 2 2 1") + "kinds: vector domain domain domain\n",
       "axis 0 is not in space"},
      {with("dimension: 3\nsizes: 2 3 2", "dimension: 4\nsizes: 3 2 2 1") +
           "space directions: none (1,0,0) (0,1,0) (0,0,1)\n",
       "frames"},
      {with("dimension: 3\nsizes: 2 3 2", "dimension: 4\nsizes: 1 1 1 99999999"), "told apart"},
      {std::string("NRRD0004\n") + std::string(2000000, 'x'), "longer than"},
  };
  const Scratch scratch;
  for (const Refusal& refusal : refusals) {
    const std::string path = scratch.write("a.nrrd", refusal.header + "\n" + sampleText(SampleType::kF32, 12, false));
    const Fault fault = faultOf([&] { readAll(path); });
    const std::string message = fault.file + ": " + fault.place + ": " + fault.what + "; " + fault.remedy;
    EXPECT_NE(message.find(refusal.words), std::string::npos) << message << "\n for " << refusal.header.substr(0, 300);
    EXPECT_FALSE(fault.file.empty());
  }
}

TEST(NrrdHostile, AGzipBombIsNotBelievedBeforeItIsRead) {
  const Scratch scratch;
  const std::string header = replaced(smallHeader("gzip"), "2 3 2", "100000 100000 100");
  const Fault fault = faultOf([&] { NrrdFile(scratch.write("a.nrrd", header + "\n" + gzipped("abc"))); });
  EXPECT_NE(fault.what.find("short"), std::string::npos) << fault.what;
}

TEST(NrrdHostile, MoreDecodedBytesThanTheSizesAskForAreAnError) {
  const Scratch scratch;
  const std::string path =
      scratch.write("a.nrrd", smallHeader("gzip") + "\n" + gzipped(sampleText(SampleType::kF32, 13, false)));
  const Fault fault = faultOf([&] { readAll(path); });
  EXPECT_NE(fault.what.find("goes on after the 48 decoded bytes"), std::string::npos) << fault.what;
}

}  // namespace
}  // namespace tet4d::exchange
