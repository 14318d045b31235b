// The structure of a VTK XML file (.vti, .vtu, .pvd …): its elements, and where in the file their text stands. The
// numbers of its arrays are read by vtk_array.h.
//
// expat reads up to <AppendedData>, behind which raw data are no XML any more. Nothing is expanded: a document type,
// and so every entity of a file's own, is refused. What is held is the elements and their attributes, never their text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libpreprocess/exchange/input_file.h"

namespace tet4d::exchange {

// Limits against hostile files.
inline constexpr std::size_t kMaxXmlDepth = 32;
inline constexpr std::size_t kMaxXmlElements = std::size_t{1} << 20;
inline constexpr std::uint64_t kMaxXmlTokenBytes = std::uint64_t{1} << 20;      // of one tag, comment, …
inline constexpr std::uint64_t kMaxXmlAttributeBytes = std::uint64_t{1} << 26;  // of all attributes together

struct XmlElement {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;
  std::uint64_t line = 0;  // of its tag, 1-based
  // Its own text in the file, from the first byte that is no blank to behind the last; empty if there is none.
  std::uint64_t text_begin = 0, text_end = 0;

  const std::string* attribute(std::string_view attribute_name) const;
  const XmlElement* child(std::string_view child_name) const;  // the first of the name
};

// The data behind the XML.
struct VtkAppended {
  bool base64 = false;
  std::uint64_t begin = 0;  // in the file, behind the underscore
};

struct VtkDocument {
  std::string path;
  std::uint64_t file_bytes = 0;
  XmlElement root;         // <VTKFile>
  std::string type;        // "ImageData", …
  std::string compressor;  // of binary and appended data, empty if there is none
  bool big_endian = false;
  bool wide_headers = false;  // sizes before binary data are 64-bit numbers, otherwise 32-bit
  std::optional<VtkAppended> appended;

  // The element that is called as the file's type.
  const XmlElement& dataset() const;
  // Throws Error{kBadInput} at an element: "line 12, <DataArray> \"p\"".
  [[noreturn]] void fail(const XmlElement& element, const std::string& what, const std::string& remedy) const;
  // An attribute that must be there, and one that must be a whole number from 0 on.
  const std::string& need(const XmlElement& element, std::string_view attribute) const;
  std::uint64_t needCount(const XmlElement& element, std::string_view attribute) const;
  // Exactly `count` numbers of an attribute; the defaults if it is not there (and they are `count`).
  std::vector<double> numbers(const XmlElement& element, std::string_view attribute, std::size_t count,
                              std::vector<double> defaults) const;
};

// Reads the structure. Throws Error{kBadInput} naming the line: no XML, no VTK file, a document type, a file over the
// limits, an element that is not closed. O(file up to the appended data), memory O(elements).
VtkDocument readVtkDocument(const InputFile& file);

}  // namespace tet4d::exchange
