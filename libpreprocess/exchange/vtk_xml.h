// VTK's XML files with appended raw data: the header lists arrays by their offsets, the data follow in the same order,
// each behind its size as a 64-bit number.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {

// Collects the header's arrays and their offsets.
class VtkHeader {
 public:
  explicit VtkHeader(std::string_view type);  // "PolyData", "UnstructuredGrid"
  // Raw XML of the header.
  void add(std::string_view xml) { text_ += xml; }
  // Declares the next array, `bytes` long, of a type such as "Float32".
  void array(std::string_view type, std::string_view name, unsigned components, std::uint64_t bytes);
  // The field TimeValue.
  void timeValue(double time);
  // The whole text before the first array's data.
  std::string finish() const;

 private:
  std::string type_, text_;
  std::uint64_t offset_ = 0;
};

// Begins an array's data of `bytes` bytes; the caller then writes them.
inline void beginVtkArray(outofcore::OutputFile& file, std::uint64_t bytes) { file.writeValue(bytes); }

// What follows the last array's data.
inline constexpr std::string_view kVtkEnd = "\n  </AppendedData>\n</VTKFile>\n";

// Text made safe for an XML attribute.
std::string xmlText(std::string_view text);

}  // namespace tet4d::exchange
