// VTK XML files made for tests, by other means than the project's readers and writers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/sample_type.h"

namespace tet4d::testing {

enum class VtkForm { kAscii, kInline, kAppendedRaw, kAppendedBase64 };

// How a file's arrays are written.
struct VtkStyle {
  VtkForm form = VtkForm::kAppendedRaw;
  bool compressed = false, wide = true, big_endian = false;
  std::size_t block_bytes = 24;  // of a compressed block, decoded
  std::string name() const;
};

// Every form with every compressor, size of headers and byte order.
std::vector<VtkStyle> allVtkStyles();

class VtkText {
 public:
  explicit VtkText(const VtkStyle& style) : style_(style) {}
  // A <DataArray>; `native` are its values in this machine's order.
  std::string array(SampleType type, const std::string& name, std::size_t components, std::string_view native,
                    const std::string& more = "");
  // The whole file around a body such as <ImageData …>…</ImageData>.
  std::string file(const std::string& type, const std::string& body) const;

 private:
  std::string encoded(const std::string& bytes) const;
  VtkStyle style_;
  std::string appended_;
};

std::string base64(std::string_view bytes);

// The bytes of values, to be given to VtkText::array().
template <class T>
std::string bytesOf(const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A .vti of 4 x 3 x 2 points with the float array "a" holding 0, 1, 2 …, and the time 2.5.
std::string smallVti(const VtkStyle& style);

}  // namespace tet4d::testing
