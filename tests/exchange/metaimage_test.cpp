// MetaImage: types, orders, where the data are, positions as ITK reads them, times; and each refusal.
#include <gtest/gtest.h>
#include <zlib.h>

#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/exchange/read_metaimage.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::gzipped;
using testing::nativeSamples;
using testing::sampleText;
using testing::Scratch;

std::string zlibbed(const std::string& text) {
  std::string out(compressBound(static_cast<uLong>(text.size())), '\0');
  auto size = static_cast<uLongf>(out.size());
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(text.data()),
                     static_cast<uLong>(text.size())),
            Z_OK);
  out.resize(size);
  return out;
}

// A header of 2 x 3 x 2 floats without its last key.
std::string header(const std::string& lines = "", const std::string& type = "MET_FLOAT") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 2 3 2\nElementType = " + type + "\n" + lines;
}
constexpr const char* kLocal = "ElementDataFile = LOCAL\n";

// Three frames along the last axis.
std::string header4(const std::string& lines = "") {
  return "ObjectType = Image\nNDims = 4\nDimSize = 2 3 2 3\nElementType = MET_FLOAT\n" + lines;
}

std::string floats(std::size_t count = 12, std::uint64_t first = 0) {
  return sampleText(SampleType::kF32, count, false, first);
}

std::vector<std::byte> readFrame(FrameFile& file, std::uint64_t k = 0) {
  std::vector<std::byte> samples(static_cast<std::size_t>(file.header().frameBytes()));
  file.readFrame(k, samples);
  return samples;
}

std::vector<std::byte> readAll(const std::string& path) {
  MetaImageFile file(path);
  std::vector<std::byte> all;
  for (std::uint64_t k = 0; k < file.header().frames; ++k) {
    const auto frame = readFrame(file, k);
    all.insert(all.end(), frame.begin(), frame.end());
  }
  return all;
}

TEST(MetaImage, EveryTypeAndByteOrder) {
  const std::vector<std::pair<std::string, SampleType>> types{
      {"MET_CHAR", SampleType::kI8},        {"MET_UCHAR", SampleType::kU8},  {"MET_SHORT", SampleType::kI16},
      {"MET_USHORT", SampleType::kU16},     {"MET_INT", SampleType::kI32},   {"MET_UINT", SampleType::kU32},
      {"MET_LONG", SampleType::kI32},       {"MET_ULONG", SampleType::kU32}, {"MET_LONG_LONG", SampleType::kI64},
      {"MET_ULONG_LONG", SampleType::kU64}, {"MET_FLOAT", SampleType::kF32}, {"MET_DOUBLE", SampleType::kF64}};
  const Scratch scratch;
  for (const auto& [name, type] : types) {
    for (const bool big : {false, true}) {
      for (const char* key : {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}) {
        const std::string order = std::string(key) + (big ? " = True\n" : " = False\n");
        const std::string data = sampleText(type, 12, big, 100);
        const std::string path = scratch.write("a.mha", header(order, name) + kLocal + data);
        EXPECT_EQ(readAll(path), nativeSamples(type, 12, 100)) << name << big;
        scratch.write("b.zraw", zlibbed(data));
        const std::string packed =
            header(order + "CompressedData = True\nCompressedDataSize = 9\n", name) + "ElementDataFile = b.zraw\n";
        EXPECT_EQ(readAll(scratch.write("b.mhd", packed)), nativeSamples(type, 12, 100)) << name << big;
      }
    }
  }
}

TEST(MetaImage, WhereTheDataAre) {
  const Scratch scratch;
  const auto expected = nativeSamples(SampleType::kF32, 12);
  const std::string zip = "CompressedData = True\n";
  scratch.write("s/plain.raw", floats());
  scratch.write("s/two words.raw", floats());
  scratch.write("s/behind.raw", "12345" + floats());
  scratch.write("s/packed.zraw", zlibbed(floats()));
  scratch.write("s/packed.gz", "123" + gzipped(floats()));
  for (const int z : {0, 1}) {
    const std::string half = floats(6, static_cast<std::uint64_t>(6 * z));
    scratch.write("s/z_" + std::to_string(10 + 2 * z) + ".raw", half);
    scratch.write("s/z_" + std::to_string(1 + z) + ".raw", half);
    scratch.write("s/p_" + std::to_string(1 + z) + ".zraw", zlibbed(half));
  }
  for (const std::string& text : std::vector<std::string>{
           header() + kLocal + floats(),
           header(zip) + kLocal + zlibbed(floats()),
           header(zip) + kLocal + gzipped(floats()),
           header("HeaderSize = 200\n") + kLocal + std::string(200 - header("HeaderSize = 200\n").size() - 24, '.') +
               floats(),
           header("HeaderSize = -1\n") + kLocal + "anything" + floats(),
           header() + "ElementDataFile = plain.raw\n",
           header() + "ElementDataFile = two words.raw\n",
           header() + "ElementDataFile=plain.raw\r\n",
           header() + "ElementDataFile = plain.raw",
           header() + "ElementDataFile = " + scratch.path("s/plain.raw") + "\n",
           header("HeaderSize = 5\n") + "ElementDataFile = behind.raw\n",
           header("HeaderSize = -1\n") + "ElementDataFile = behind.raw\n",
           header(zip) + "ElementDataFile = packed.zraw\n",
           header(zip + "HeaderSize = 3\n") + "ElementDataFile = packed.gz\n",
           header() + "ElementDataFile = LIST\nz_1.raw\nz_2.raw\n",
           header() + "ElementDataFile = LIST 2D\nz_1.raw\n\nz_2.raw\n",
           header() + "ElementDataFile = LIST 3\nplain.raw\n",
           header(zip) + "ElementDataFile = LIST\np_1.zraw\np_2.zraw\n",
           header() + "ElementDataFile = z_%d.raw\n",
           header() + "ElementDataFile = z_%d.raw 1\n",
           header() + "ElementDataFile = z_%d.raw 10 12\n",
           header() + "ElementDataFile = z_%d.raw 10 12 2\n",
           header() + "ElementDataFile = z_%d.raw 10 13 2\n",
       }) {
    EXPECT_EQ(readAll(scratch.write("s/a.mhd", text)), expected) << text;
  }
}

TEST(MetaImage, LayersAloneAcrossFiles) {
  const Scratch scratch;
  for (const int z : {1, 2})
    scratch.write("z_" + std::to_string(z) + ".raw", floats(6, static_cast<std::uint64_t>(6 * z)));
  MetaImageFile file(scratch.write("a.mhd", header() + "ElementDataFile = z_%d.raw\n"));
  std::vector<std::byte> layer(24);
  file.readLayers(0, 1, 2, layer);
  EXPECT_EQ(layer, nativeSamples(SampleType::kF32, 6, 12));
  file.readLayers(0, 0, 1, layer);
  EXPECT_EQ(layer, nativeSamples(SampleType::kF32, 6, 6));
}

TEST(MetaImage, PositionsAsItkReadsThem) {
  const Scratch scratch;
  const auto mapOf = [&](const std::string& lines) {
    return MetaImageFile(scratch.write("a.mha", header(lines) + kLocal + floats())).header().grid.index_to_world;
  };
  EXPECT_EQ(mapOf(""), AffineMap{});
  // Row i of the matrix is the direction of axis i; the offset is the first sample, not a corner.
  const AffineMap turned = mapOf(
      "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 5 6 7\nElementSpacing = 2 3 4\n"
      "CenterOfRotation = 9 9 9\nAnatomicalOrientation = RAI\n");
  EXPECT_EQ(turned.origin, (std::array<double, 3>{5, 6, 7}));
  EXPECT_EQ(turned.axes[0], (std::array<double, 3>{0, 2, 0}));
  EXPECT_EQ(turned.axes[1], (std::array<double, 3>{-3, 0, 0}));
  EXPECT_EQ(turned.axes[2], (std::array<double, 3>{0, 0, 4}));
  EXPECT_EQ(mapOf("Rotation = 0 1 0 -1 0 0 0 0 1\nPosition = 5 6 7\nElementSize = 2 3 4\n"), turned);
  EXPECT_EQ(mapOf("Orientation = 0 1 0 -1 0 0 0 0 1\nOrigin = 5 6 7\nElementSize = 1 1 1\nElementSpacing = 2 3 4\n"),
            turned);
}

TEST(MetaImage, FramesAlongTheLastAxis) {
  const Scratch scratch;
  const auto timesOf = [&](const std::string& lines) {
    return openFrames({scratch.write("a.mha", header4(lines) + kLocal + floats(36))})->times();
  };
  EXPECT_EQ(timesOf(""), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(timesOf("ElementSpacing = 1 1 1 0.25\nOffset = 0 0 0 2\n"), (std::vector<double>{2, 2.25, 2.5}));
  EXPECT_EQ(timesOf("Offset = 0 0 0 2\n"), (std::vector<double>{2, 3, 4}));
  EXPECT_EQ(timesOf("TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nElementSpacing = 1 1 1 5\n"),
            (std::vector<double>{0, 5, 10}));
  for (const bool packed : {false, true}) {
    const std::string lines = packed ? "CompressedData = True\n" : "";
    const auto source =
        openFrames({scratch.write("a.mha", header4(lines) + kLocal + (packed ? zlibbed(floats(36)) : floats(36)))});
    for (const std::size_t k : {2U, 0U, 1U})
      EXPECT_EQ(testing::frameByLayers(*source, k), nativeSamples(SampleType::kF32, 12, 12 * k)) << k << packed;
  }
  for (std::uint64_t k = 0; k < 3; ++k) scratch.write("f_" + std::to_string(k), floats(12, 12 * k));
  const std::string listed = header4() + "ElementDataFile = LIST 3D\nf_0\nf_1\nf_2\n";
  EXPECT_EQ(readAll(scratch.write("l.mhd", listed)), nativeSamples(SampleType::kF32, 36));
  EXPECT_EQ(readAll(scratch.write("p.mhd", header4() + "ElementDataFile = f_%d 0 2 1\n")),
            nativeSamples(SampleType::kF32, 36));
}

TEST(MetaImage, SeriesAndFilesWithoutASuffix) {
  const Scratch scratch;
  for (std::uint64_t k = 0; k < 3; ++k) {
    scratch.write("d/a_" + std::to_string(k) + ".mhd",
                  header() + "ElementDataFile = a_" + std::to_string(k) + ".raw\n");
    scratch.write("d/a_" + std::to_string(k) + ".raw", floats(12, 100 * k));
  }
  for (const char* input : {"d", "d/a_%d.mhd"}) {
    const auto source = openFrames({scratch.path(input)});
    ASSERT_EQ(source->times().size(), 3u);
    EXPECT_EQ(testing::frameOf(*source, 2), nativeSamples(SampleType::kF32, 12, 200));
  }
  EXPECT_EQ(openFrames({scratch.write("volume", header() + kLocal + floats())})->times().size(), 1u);
  EXPECT_EQ(openFrames({scratch.write("other", header().substr(19) + kLocal + floats())})->times().size(), 1u);
  scratch.write("d/z.nrrd", testing::smallFile());
  const Fault fault = faultOf([&] { openFrames({scratch.path("d")}); });
  EXPECT_NE(fault.what.find("a_0.mhd"), std::string::npos) << fault.what;
  EXPECT_NE(fault.what.find("z.nrrd"), std::string::npos) << fault.what;
}

TEST(MetaImageHostile, EveryPrefixIsAnErrorThatNamesTheFile) {
  const Scratch scratch;
  for (const std::string& whole :
       {header() + kLocal + floats(), header("CompressedData = True\n") + kLocal + zlibbed(floats())}) {
    ASSERT_EQ(readAll(scratch.write("a.mha", whole)), nativeSamples(SampleType::kF32, 12));
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const std::string path = scratch.write("a.mha", std::string_view(whole).substr(0, length));
      const Fault fault = faultOf([&] { readAll(path); });
      ASSERT_TRUE(fault.code == FaultCode::kBadInput || fault.code == FaultCode::kIo) << length;
      ASSERT_TRUE(fault.file.starts_with(scratch.path(""))) << length << " " << fault.file;
    }
  }
}

TEST(MetaImageHostile, ChangedBytesGiveErrorsOrSamples) {
  const Scratch scratch;
  const std::string whole = header("CompressedData = True\n") + kLocal + zlibbed(floats());
  const std::size_t data_at = whole.size() - zlibbed(floats()).size();
  int refused = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char flip : {'\x01', '\x80', '\xff'}) {
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ flip);
      try {
        const auto samples = readAll(scratch.write("a.mha", changed));
        if (i < data_at) continue;  // a changed header may mean another grid
        ASSERT_EQ(samples, nativeSamples(SampleType::kF32, 12)) << i;
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 200);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(MetaImageHostile, EachBadHeaderIsNamed) {
  const auto with = [&](const std::string& from, const std::string& to) {
    return replaced(header() + kLocal, from, to);
  };
  const auto data = [](const std::string& text) { return header() + "ElementDataFile = " + text + "\n"; };
  const std::string turn = "TransformMatrix = ";
  const std::vector<std::pair<std::string, std::string>> refusals{
      {with("Image", "Tube"), "Tube"},
      {with("NDims = 3", "NDims = 2"), "expected 3"},
      {with("NDims = 3", "NDims = 99999999999"), "expected 3"},
      {with("NDims = 3\n", ""), "NDims is missing"},
      {with("NDims = 3", "NDims = 4"), "DimSize has 3 sizes, but NDims is 4"},
      {with("2 3 2", "2 3"), "DimSize has 2 sizes"},
      {with("2 3 2", "2 0 2"), "from 1 on"},
      {with("2 3 2", "2 -3 2"), "from 1 on"},
      {with("2 3 2", "2 x 2"), "from 1 on"},
      {with("2 3 2", "4294967296 4294967296 4294967296"), "2^63"},
      {with("2 3 2", "1000000 1000000 1000"), "short"},
      {with("2 3 2", "2 3 3"), "short: it holds 48 bytes"},
      {with("2 3 2", "2 2 2"), "goes on for 16 bytes"},
      {with("DimSize = 2 3 2\n", ""), "DimSize is missing"},
      {with("MET_FLOAT", "MET_STRING"), "MET_STRING"},
      {with("MET_FLOAT", "MET_FLOAT_ARRAY"), "MET_FLOAT_ARRAY"},
      {with("ElementType = MET_FLOAT\n", ""), "ElementType is missing"},
      {with("True", "False"), "numbers as text"},
      {with("True", "maybe"), "expected True or False"},
      {header("ElementNumberOfChannels = 3\n") + kLocal, "3\" values a sample"},
      {header("ElementSpacing = 1 0 1\n") + kLocal, "is 0"},
      {header("ElementSpacing = 1 nan 1\n") + kLocal, "no finite number"},
      {header("ElementSpacing = 1 1\n") + kLocal, "2 numbers, expected 3"},
      {header("ElementSpacing = 1e-200 1e-200 1\n") + kLocal, "lie in a plane"},
      {header("Offset = 1 inf 1\n") + kLocal, "no finite number"},
      {header(turn + "1 0 0 0 1 0 1 1 0\n") + kLocal, "lie in a plane"},
      {header(turn + "1 0 0 0 1 0 1 1\n") + kLocal, "8 numbers, expected 9"},
      {header("HeaderSize = 3\n") + kLocal, "but the header has"},
      {header("HeaderSize = -2\n") + kLocal, "no count"},
      {header("HeaderSize = 9223372036854775807\n") + kLocal, "short"},
      {header("HeaderSize = -1\nCompressedData = True\n") + kLocal, "not compressed"},
      {header("NDims = 3\n") + kLocal, "given twice"},
      {header("nonsense\n") + kLocal, "nonsense"},
      {header(" = 3\n") + kLocal, "Key = value"},
      {header(), "ElementDataFile"},
      {data(""), "no file is named"},
      {data("gone.raw"), "cannot be opened"},
      {data("."), "regular file"},
      {data("LIST"), "0 files are listed, but DimSize asks for 2"},
      {data("LIST 0D"), "LIST 2D"},
      {data("LIST two"), "LIST 2D"},
      {data("LIST\na\nb\nc"), "3 files are listed"},
      {data("z_%d.raw 0 5 1"), "numbers for 2 files"},
      {data("z_%d.raw 0 1 0"), "a step above 0"},
      {data("z_%d.raw 5 5"), "a step above 0"},
      {data("z_%d.raw 1 2 1 3 4"), "PATTERN MIN MAX STEP"},
      {data("z_%s.raw 1 2 1"), "PATTERN MIN MAX STEP"},
      {data("z_%d.raw 0 9223372036854775807 1"), "PATTERN MIN MAX STEP"},
      {data("z_%d.raw 0 1 1"), "cannot be opened"},
      {header4("ElementSpacing = 1 1 1 -1\n") + kLocal + floats(24), "frame 1"},
      {header4("ElementSpacing = 1 1 1 0\n") + kLocal + floats(24), "is 0"},
      {header4(turn + "1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n") + kLocal + floats(24), "space and time"},
      {header4(turn + "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1\n") + kLocal + floats(24), "space and time"},
      {replaced(header4(), "2 3 2 3", "1 1 1 99999999") + kLocal, "told apart"},
      {std::string("ObjectType = ") + std::string(2000000, 'x'), "longer than"},
  };
  const Scratch scratch;
  for (const auto& [text, words] : refusals) {
    const bool local = text.ends_with("LOCAL\n") || text.find("LOCAL\n") != std::string::npos;
    const std::string path = scratch.write("a.mhd", local ? text + floats() : text);
    const Fault fault = faultOf([&] { readAll(path); });
    const std::string message = fault.file + ": " + fault.place + ": " + fault.what + "; " + fault.remedy;
    EXPECT_NE(message.find(words), std::string::npos) << message << "\n for " << text.substr(0, 300);
    EXPECT_FALSE(fault.file.empty());
  }
}

TEST(MetaImageHostile, AZlibBombIsNotBelievedBeforeItIsRead) {
  const Scratch scratch;
  const std::string text = replaced(header("CompressedData = True\n"), "2 3 2", "100000 100000 100") + kLocal;
  const Fault fault = faultOf([&] { MetaImageFile(scratch.write("a.mha", text + zlibbed("abc"))); });
  EXPECT_NE(fault.what.find("short"), std::string::npos) << fault.what;
}

}  // namespace
}  // namespace tet4d::exchange
