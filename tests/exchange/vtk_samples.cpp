#include "tests/exchange/vtk_samples.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <sstream>

#include "tests/exchange/nrrd_samples.h"

namespace tet4d::testing {
namespace {

const char* vtkName(SampleType type) {
  constexpr const char* kNames[] = {"?",     "UInt8",  "Int8",  "UInt16",  "Int16",  "UInt32",
                                    "Int32", "UInt64", "Int64", "Float32", "Float64"};
  return kNames[static_cast<std::size_t>(type)];
}

template <class T, class Shown>
void print(std::ostringstream& out, std::string_view native) {
  out.precision(17);
  for (std::size_t i = 0; i < native.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, native.data() + i, sizeof value);
    out << (i == 0 ? "" : i % 5 == 0 ? "\n  " : " ") << static_cast<Shown>(value);
  }
}

std::string asciiText(SampleType type, std::string_view native) {
  std::ostringstream out;
  switch (type) {
    case SampleType::kU8:
      print<std::uint8_t, unsigned>(out, native);
      break;
    case SampleType::kI8:
      print<std::int8_t, int>(out, native);
      break;
    case SampleType::kU16:
      print<std::uint16_t, unsigned>(out, native);
      break;
    case SampleType::kI16:
      print<std::int16_t, int>(out, native);
      break;
    case SampleType::kU32:
      print<std::uint32_t, std::uint32_t>(out, native);
      break;
    case SampleType::kI32:
      print<std::int32_t, std::int32_t>(out, native);
      break;
    case SampleType::kU64:
      print<std::uint64_t, std::uint64_t>(out, native);
      break;
    case SampleType::kI64:
      print<std::int64_t, std::int64_t>(out, native);
      break;
    case SampleType::kF32:
      print<float, float>(out, native);
      break;
    case SampleType::kF64:
      print<double, double>(out, native);
      break;
  }
  return out.str();
}

std::string reversedEach(std::string bytes, std::size_t size) {
  for (std::size_t i = 0; i + size <= bytes.size(); i += size) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i), bytes.begin() + static_cast<std::ptrdiff_t>(i + size));
  }
  return bytes;
}

std::string word(std::uint64_t value, const VtkStyle& style) {
  std::string bytes;
  for (int i = 0; i < (style.wide ? 8 : 4); ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return style.big_endian ? reversedEach(bytes, bytes.size()) : bytes;
}

std::string deflated(std::string_view bytes) {
  std::string out(compressBound(static_cast<uLong>(bytes.size())), '\0');
  auto size = static_cast<uLongf>(out.size());
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                     static_cast<uLong>(bytes.size())),
            Z_OK);
  out.resize(size);
  return out;
}

}  // namespace

std::string VtkStyle::name() const {
  constexpr const char* kForms[] = {"ascii", "inline", "raw", "base64"};
  return std::string(kForms[static_cast<std::size_t>(form)]) + (compressed ? " zlib" : "") + (wide ? " 64" : " 32") +
         (big_endian ? " big" : " little");
}

std::vector<VtkStyle> allVtkStyles() {
  std::vector<VtkStyle> styles;
  for (const VtkForm form : {VtkForm::kAscii, VtkForm::kInline, VtkForm::kAppendedRaw, VtkForm::kAppendedBase64}) {
    for (unsigned bits = 0; bits < 8; ++bits) {
      styles.push_back({form, (bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0});
    }
  }
  return styles;
}

std::string base64(std::string_view bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

// What stands in the file for an array's bytes: sizes, blocks, base64.
std::string VtkText::encoded(const std::string& bytes) const {
  const bool is_base64 = style_.form != VtkForm::kAppendedRaw;
  if (!style_.compressed) {
    const std::string all = word(bytes.size(), style_) + bytes;
    return is_base64 ? base64(all) : all;
  }
  const std::size_t count = (bytes.size() + style_.block_bytes - 1) / style_.block_bytes;
  std::string head =
      word(count, style_) + word(style_.block_bytes, style_) + word(bytes.size() % style_.block_bytes, style_);
  std::string blocks;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string block = deflated(bytes.substr(i * style_.block_bytes, style_.block_bytes));
    head += word(block.size(), style_);
    blocks += block;
  }
  return is_base64 ? base64(head) + base64(blocks) : head + blocks;
}

std::string VtkText::array(SampleType type, const std::string& name, std::size_t components, std::string_view native,
                           const std::string& more) {
  std::string text = "<DataArray type=\"" + std::string(vtkName(type)) + "\" Name=\"" + name +
                     "\" NumberOfComponents=\"" + std::to_string(components) + "\" " + more;
  if (style_.form == VtkForm::kAscii)
    return text + "format=\"ascii\">\n  " + asciiText(type, native) + "\n</DataArray>\n";
  std::string bytes(native);
  if (style_.big_endian) bytes = reversedEach(bytes, sampleBytes(type));
  if (style_.form == VtkForm::kInline) return text + "format=\"binary\">\n  " + encoded(bytes) + "\n</DataArray>\n";
  text += "format=\"appended\" offset=\"" + std::to_string(appended_.size()) + "\"/>\n";
  appended_ += encoded(bytes);
  return text;
}

std::string VtkText::file(const std::string& type, const std::string& body) const {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type + "\" version=\"1.0\" byte_order=\"" +
                     (style_.big_endian ? "BigEndian" : "LittleEndian") + "\" header_type=\"" +
                     (style_.wide ? "UInt64" : "UInt32") + "\"" +
                     (style_.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "") + ">\n" + body;
  if (!appended_.empty()) {
    text += std::string("<AppendedData encoding=\"") + (style_.form == VtkForm::kAppendedRaw ? "raw" : "base64") +
            "\">\n   _" + appended_ + "\n</AppendedData>\n";
  }
  return text + "</VTKFile>\n";
}

std::string smallVti(const VtkStyle& style) {
  VtkText text(style);
  const std::string time = "<FieldData>" +
                           text.array(SampleType::kF64, "TimeValue", 1, bytesOf(std::vector<double>{2.5})) +
                           "</FieldData>\n";
  const std::string values = text.array(SampleType::kF32, "a", 1, sampleText(SampleType::kF32, 24, false));
  return text.file("ImageData", "<ImageData WholeExtent=\"0 3 0 2 0 1\" Origin=\"1 2 3\" Spacing=\"0.5 1 2\">\n" +
                                    time + "<Piece Extent=\"0 3 0 2 0 1\"><PointData Scalars=\"a\">\n" + values +
                                    "</PointData></Piece>\n</ImageData>\n");
}

}  // namespace tet4d::testing
