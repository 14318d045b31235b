// Arrays of VTK XML files: every form, compressor, size of headers, byte order and type, against a writer of the tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "libpreprocess/exchange/vtk_array.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"
#include "tests/exchange/vtk_samples.h"

namespace tet4d::exchange {
namespace {

using testing::bytesOf;
using testing::faultOf;
using testing::sampleText;
using testing::Scratch;
using testing::VtkForm;
using testing::VtkStyle;
using testing::VtkText;

// The first array of a file <Field>…</Field>.
struct OneArray {
  explicit OneArray(const std::string& path, std::uint64_t tuples) : file(std::make_shared<InputFile>(path)) {
    document = readVtkDocument(*file);
    const XmlElement& set = document.dataset();
    if (set.children.empty()) document.fail(set, "no array", "test");
    array = openVtkArray(document, set.children[0], file, tuples);
  }
  std::vector<std::byte> read(std::uint64_t first, std::uint64_t count) const {
    std::vector<std::byte> samples(count * sampleBytes(array->type()));
    array->read(first, samples);
    return samples;
  }
  std::vector<double> numbers() const {
    std::vector<double> values(array->values());
    array->readNumbers(0, values);
    return values;
  }
  std::shared_ptr<const InputFile> file;
  VtkDocument document;
  std::unique_ptr<VtkArray> array;
};

std::string oneArray(const VtkStyle& style, SampleType type, std::string_view native) {
  VtkText text(style);
  const std::string before = style.form == VtkForm::kAscii ? "" : "<!-- < & \" -->";
  const std::string array = text.array(type, "a", 1, native);
  return text.file("Field", "<Field>" + array + before + "</Field>\n");
}

class EveryStyle : public ::testing::TestWithParam<VtkStyle> {};
class SomeStyles : public ::testing::TestWithParam<VtkStyle> {};

TEST_P(EveryStyle, HoldsEveryTypeAndIsReadFromAnyPlace) {
  const Scratch scratch;
  for (unsigned t = 1; t <= 10; ++t) {
    const auto type = static_cast<SampleType>(t);
    constexpr std::size_t kCount = 1000;
    const std::string native = sampleText(type, kCount, false, 3);
    const OneArray one(scratch.write("a.vtx", oneArray(GetParam(), type, native)), kCount);
    ASSERT_EQ(one.array->type(), type);
    const auto expected = testing::nativeSamples(type, kCount, 3);
    EXPECT_EQ(one.read(0, kCount), expected) << sampleName(type);
    // Forwards over gaps, backwards, single values, across blocks.
    const std::size_t bytes = sampleBytes(type);
    for (const auto& [first, count] : std::vector<std::pair<std::size_t, std::size_t>>{
             {10, 5}, {17, 40}, {400, 600}, {0, 1}, {999, 1}, {998, 2}, {500, 0}, {3, 13}}) {
      const std::vector<std::byte> part(expected.begin() + static_cast<std::ptrdiff_t>(first * bytes),
                                        expected.begin() + static_cast<std::ptrdiff_t>((first + count) * bytes));
      EXPECT_EQ(one.read(first, count), part) << sampleName(type) << " at " << first;
    }
  }
}

TEST_P(SomeStyles, EveryPrefixIsAnErrorThatNamesTheFile) {
  const Scratch scratch;
  const std::string whole = oneArray(GetParam(), SampleType::kF32, sampleText(SampleType::kF32, 20, false));
  const std::size_t needed = whole.rfind(GetParam().form == VtkForm::kAppendedRaw ? "\n</App" : "</Field>");
  for (std::size_t length = 0; length < needed; ++length) {
    const std::string path = scratch.write("a.vtx", std::string_view(whole).substr(0, length));
    try {
      OneArray one(path, 20);
      // Base64 ends with its last digit; what is cut off behind it is not needed.
      if (one.read(0, 20) == testing::nativeSamples(SampleType::kF32, 20) && length + 60 > whole.size()) continue;
      FAIL() << length;
    } catch (const Error& error) {
      ASSERT_EQ(error.fault().code, FaultCode::kBadInput) << length;
      ASSERT_EQ(error.fault().file, path) << length;
      ASSERT_FALSE(error.fault().place.empty()) << length << error.fault().what;
    }
  }
}

TEST_P(SomeStyles, ChangedBytesGiveErrorsOrNumbersNeverMore) {
  const Scratch scratch;
  const std::string whole = oneArray(GetParam(), SampleType::kF64, sampleText(SampleType::kF64, 7, false));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char flip : {'\x01', '\xff'}) {
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ flip);
      const std::string path = scratch.write("a.vtx", changed);
      try {
        const OneArray one(path, 7);
        (void)one.numbers();
      } catch (const Error& error) {
        ASSERT_EQ(error.fault().file, path) << i << error.fault().what;
      }
    }
  }
}

std::string styleName(const ::testing::TestParamInfo<VtkStyle>& style) {
  std::string name = style.param.name();
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Vtk, EveryStyle, ::testing::ValuesIn(testing::allVtkStyles()), styleName);
INSTANTIATE_TEST_SUITE_P(Vtk, SomeStyles,
                         ::testing::Values(VtkStyle{VtkForm::kAscii, false, false, false},
                                           VtkStyle{VtkForm::kInline, false, false, true},
                                           VtkStyle{VtkForm::kInline, true, true, false},
                                           VtkStyle{VtkForm::kAppendedRaw, false, true, true},
                                           VtkStyle{VtkForm::kAppendedRaw, true, false, false},
                                           VtkStyle{VtkForm::kAppendedBase64, false, true, false},
                                           VtkStyle{VtkForm::kAppendedBase64, true, false, true}),
                         styleName);

TEST(VtkArrayForms, AHeaderEncodedOnItsOwnIsReadToo) {
  const Scratch scratch;
  for (const bool wide : {false, true}) {
    const std::string bytes = bytesOf(std::vector<float>{1, 2, 3, 4});
    std::string size(wide ? 8 : 4, '\0');
    size[0] = 16;
    const std::string text = "<VTKFile type=\"F\" byte_order=\"LittleEndian\" header_type=\"" +
                             std::string(wide ? "UInt64" : "UInt32") +
                             "\"><F><DataArray type=\"Float32\" Name=\"a\" format=\"binary\">\n" +
                             testing::base64(size) + testing::base64(bytes) + "\n</DataArray></F></VTKFile>";
    EXPECT_EQ(OneArray(scratch.write("a.vtx", text), 4).numbers(), (std::vector<double>{1, 2, 3, 4}));
  }
}

TEST(VtkArrayForms, Base64MayHaveLines) {
  const Scratch scratch;
  std::string digits = testing::base64(std::string("\x18\0\0\0", 4) + bytesOf(std::vector<double>{1, 2.5, -3}));
  for (std::size_t at = 5; at < digits.size(); at += 8) digits.insert(at, "\r\n ");
  const std::string text =
      "<VTKFile type=\"F\"><F><DataArray type=\"Float64\" Name=\"a\" format=\"binary\">" + digits +
      "<InformationKey name=\"L2\" location=\"x\"><Value index=\"0\"> 7 </Value></InformationKey>\n"
      "</DataArray></F></VTKFile>";
  EXPECT_EQ(OneArray(scratch.write("a.vtx", text), 3).numbers(), (std::vector<double>{1, 2.5, -3}));
}

std::string ascii(const std::string& type, const std::string& values) {
  return "<VTKFile type=\"F\"><F><DataArray type=\"" + type + "\" Name=\"a\" format=\"ascii\">" + values +
         "</DataArray></F></VTKFile>";
}

TEST(VtkArrayStiff, TextHoldsWhatTheTypeHolds) {
  const Scratch scratch;
  const auto read = [&](const std::string& type, const std::string& values, std::size_t count) {
    return OneArray(scratch.write("a.vtx", ascii(type, values)), count).numbers();
  };
  const auto floats = read("Float32", "1e-45 1e-60 3.4028235e38 -0 inf -inf +1.5 1e-400", 8);
  EXPECT_EQ(floats, (std::vector<double>{0x1p-149, 0, std::numeric_limits<float>::max(), 0,
                                         std::numeric_limits<double>::infinity(),
                                         -std::numeric_limits<double>::infinity(), 1.5, 0}));
  EXPECT_TRUE(std::isnan(read("Float64", "nan", 1)[0]));
  EXPECT_EQ(read("Float64", "5e-324 1.7976931348623157e308", 2),
            (std::vector<double>{5e-324, std::numeric_limits<double>::max()}));
  EXPECT_EQ(read("Int8", "-128 127", 2), (std::vector<double>{-128, 127}));
  EXPECT_EQ(read("UInt64", "18446744073709551615", 1), (std::vector<double>{0x1p64}));
  for (const auto& [type, value] : std::vector<std::pair<std::string, std::string>>{{"Float32", "1e39"},
                                                                                    {"Float64", "1e309"},
                                                                                    {"Int8", "128"},
                                                                                    {"UInt8", "-1"},
                                                                                    {"Int32", "1.5"},
                                                                                    {"UInt64", "18446744073709551616"},
                                                                                    {"Float32", "1,5"},
                                                                                    {"Float32", "x"}}) {
    const Fault fault = faultOf([&, t = type, v = value] { read(t, "0 " + v, 2); });
    EXPECT_NE(fault.what.find(value), std::string::npos) << fault.what;
    EXPECT_NE(fault.place.find("value 1"), std::string::npos) << fault.place;
  }
}

TEST(VtkArrayStiff, CountsAreWholeAndNotNegative) {
  const Scratch scratch;
  const auto counts = [&](const std::string& type, const std::string& values) {
    const OneArray one(scratch.write("a.vtx", ascii(type, values)), 1);
    std::uint64_t count = 0;
    one.array->readCounts(0, std::span(&count, 1));
    return count;
  };
  EXPECT_EQ(counts("Float64", "4503599627370497"), 4503599627370497U);
  EXPECT_EQ(counts("UInt64", "18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
  for (const auto& [type, value] : std::vector<std::pair<std::string, std::string>>{
           {"Int64", "-1"}, {"Float32", "0.5"}, {"Float32", "nan"}, {"Float64", "1e300"}, {"Int8", "-7"}}) {
    EXPECT_NE(faultOf([&, t = type, v = value] { counts(t, v); }).what.find("whole number"), std::string::npos);
  }
}

struct Refusal {
  std::string text, words;
};

TEST(VtkHostile, EveryRefusalSaysWhatAndWhere) {
  const std::string head = "<VTKFile type=\"F\">";
  const std::string array = "<DataArray type=\"Float32\" Name=\"a\" ";
  const auto inside = [&](const std::string& more) { return head + "<F>" + array + more + "</F></VTKFile>"; };
  const auto appended = [&](const std::string& attributes, const std::string& data, const std::string& root = "") {
    return "<VTKFile type=\"F\" " + root + "><F>" + array + "format=\"appended\" " + attributes +
           "/></F><AppendedData encoding=\"raw\">_" + data + "</AppendedData></VTKFile>";
  };
  const std::string zlib = "compressor=\"vtkZLibDataCompressor\"";
  const auto words = [](std::initializer_list<std::uint32_t> values) {
    return bytesOf(std::vector<std::uint32_t>(values));
  };
  std::string deep = head;
  for (int i = 0; i < 100; ++i) deep += "<a>";
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE VTKFile [<!ENTITY a \"aaaaaaaaaa\">";
  bomb += "<!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;\">]>" + inside("format=\"ascii\">&b;</DataArray>");
  const std::vector<Refusal> refusals{
      {"", "no element found"},
      {"hello", "syntax error"},
      {"<html/>", "expected <VTKFile>, found <html>"},
      {"<VTKFile/>", "attribute type is missing"},
      {head + "<F>", "no element found"},
      {head + "</F>", "mismatched tag"},
      {head + "</VTKFile>", "no such element"},
      {deep, "nested deeper than 32"},
      {bomb, "document type"},
      {head + "<F " + std::string(3 << 20, 'x') + "/>", "tag or comment is longer"},
      {head + "<!--" + std::string(3 << 20, 'x'), "tag or comment is longer"},
      {"<VTKFile type=\"F\" byte_order=\"Middle\"/>", "byte_order is \"Middle\""},
      {"<VTKFile type=\"F\" header_type=\"UInt16\"/>", "header_type is \"UInt16\""},
      {inside("/>"), "attribute format is missing"},
      {inside("format=\"hex\"/>"), "format is \"hex\""},
      {inside("NumberOfComponents=\"0\" format=\"ascii\">1 2</DataArray>"), "0 components"},
      {inside("NumberOfComponents=\"-1\" format=\"ascii\">1 2</DataArray>"), "\"-1\", expected a whole number"},
      {inside("NumberOfComponents=\"9223372036854775807\" format=\"ascii\">1 2</DataArray>"), "components"},
      {inside("NumberOfComponents=\"1000000000000\" format=\"ascii\">1 2</DataArray>"), "cannot hold"},
      {inside("format=\"ascii\">1 </DataArray>"), "cannot hold"},
      {inside("format=\"ascii\">1000</DataArray>"), "ends after 1 values"},
      {inside("format=\"ascii\">1&#32;2</DataArray>"), "by its number or name"},
      {inside("format=\"ascii\">1 <!-- --> 2</DataArray>"), "divided by"},
      {inside("format=\"ascii\">1 <a/> 2</DataArray>"), "divided by"},
      {inside("format=\"binary\">AAAA</DataArray>"), "short"},
      {inside("format=\"binary\">CAAAAAAAAAAAAA=A</DataArray>"), "padding"},
      {inside("format=\"binary\">CAAA*AAAAAAAAAAA</DataArray>"), "is no base64"},
      {inside("format=\"binary\">=AAAAAAAAAAAAAAA</DataArray>"), "padding"},
      {inside("format=\"binary\">CAAAAAAAAAAA    AA==</DataArray>"), "base64 data end after"},
      {inside("format=\"appended\" offset=\"0\"/>"), "no <AppendedData>"},
      {appended("", "x"), "attribute offset is missing"},
      {appended("offset=\"1000\"", "x"), "offset is 1000"},
      {appended("offset=\"18446744073709551615\"", "x"), "offset is 18446744073709551615"},
      {appended("offset=\"0\"", words({7, 0, 0})), "data are 7 bytes, but 8 are expected"},
      {appended("offset=\"0\"", words({8})).substr(0, 130), "short"},
      {appended("offset=\"4\"", words({8})), "bytes"},
      {appended("offset=\"0\"", "x", "compressor=\"vtkLZ4DataCompressor\""), "vtkLZ4DataCompressor"},
      {appended("offset=\"0\"", "x", "compressor=\"vtkLZMADataCompressor\""), "vtkLZMADataCompressor"},
      {appended("offset=\"0\"", words({0, 8, 0}), zlib), "impossible: 0 blocks"},
      {appended("offset=\"0\"", words({0xffffffff, 8, 0}), zlib), "impossible: 4294967295 blocks"},
      {appended("offset=\"0\"", words({1, 0, 0, 4}), zlib), "impossible"},
      {appended("offset=\"0\"", words({1, 8, 9, 4}), zlib), "impossible"},
      {appended("offset=\"0\"", words({2, 8, 0, 4, 4}), zlib), "decode to 2 x 8"},
      {appended("offset=\"0\"", words({1, 8, 0, 0x7fffffff}), zlib), "ends behind the data"},
      {appended("offset=\"0\"", words({1, 8, 0, 4, 0x12345678}), zlib), "block 0"},
      {head + "<F/><AppendedData encoding=\"hex\">_", "encoded as \"hex\""},
      {head + "<F/><AppendedData encoding=\"raw\">x", "underscore"},
      {head + "<F/><AppendedData encoding=\"raw\">", "underscore"},
  };
  const Scratch scratch;
  for (const Refusal& refusal : refusals) {
    const std::string path = scratch.write("a.vtx", refusal.text);
    const Fault fault = faultOf([&] { (void)OneArray(path, 2).numbers(); });
    const std::string message = fault.file + ": " + fault.place + ": " + fault.what + "; " + fault.remedy;
    EXPECT_NE(message.find(refusal.words), std::string::npos) << message << "\n for " << refusal.text.substr(0, 300);
    EXPECT_EQ(fault.file, path);
  }
}

TEST(VtkHostile, ABlockThatCannotBeSoSmallIsNotBelieved) {
  const Scratch scratch;
  const std::string text =
      "<VTKFile type=\"F\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"><F><DataArray type=\"UInt8\" "
      "Name=\"a\" format=\"appended\" offset=\"0\"/></F><AppendedData encoding=\"raw\">_" +
      bytesOf(std::vector<std::uint64_t>{1, std::uint64_t{1} << 40, 0, 8, 0});
  const Fault fault = faultOf([&] { OneArray(scratch.write("a.vtx", text), std::uint64_t{1} << 40); });
  EXPECT_NE(fault.what.find("cannot decode to 1099511627776"), std::string::npos) << fault.what;
}

TEST(VtkHostile, BlocksThatDecodeToOtherSizesAreErrors) {
  const Scratch scratch;
  for (const std::size_t held : {std::size_t{4}, std::size_t{12}}) {
    VtkStyle style{VtkForm::kAppendedRaw, true, false, false};
    style.block_bytes = held;  // one block of `held` bytes, its table changed to tell of 8
    std::string text = oneArray(style, SampleType::kU8, std::string(held, 'x'));
    const std::size_t table = text.find("_") == std::string::npos ? 0 : text.rfind("   _") + 4;
    text[table + 4] = 8;
    const Fault fault = faultOf([&] { (void)OneArray(scratch.write("a.vtx", text), 8).numbers(); });
    EXPECT_NE(fault.place.find("block 0"), std::string::npos) << fault.place << fault.what;
    EXPECT_NE(fault.what.find("decodes to"), std::string::npos) << fault.what;
  }
}

}  // namespace
}  // namespace tet4d::exchange
