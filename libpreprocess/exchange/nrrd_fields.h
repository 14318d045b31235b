// The text of a NRRD header as fields and key/value pairs, before any of it is understood.
// Format: teem.sourceforge.net/nrrd/format.html, magics NRRD0001 to NRRD0005.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libpreprocess/exchange/header_text.h"

namespace tet4d::exchange {

inline constexpr std::size_t kMaxNrrdDimension = 16;  // as in Teem

struct NrrdField {
  std::string text;      // what follows ": ", trimmed
  std::size_t line = 0;  // 1-based
};

// A header, read but not understood. Field names are in one spelling: "axis mins" for "axismins", "centerings" for
// "centers", "data file" for "datafile", …
struct NrrdFields {
  std::string path;
  int version = 0;                                // 1 … 5
  std::map<std::string, NrrdField> fields;        // by name; each at most once
  std::map<std::string, std::string> key_values;  // key:=value, escapes resolved
  std::vector<std::string> listed_files;          // lines after "data file: LIST"
  std::uint64_t header_bytes = 0;                 // where attached data begin

  const NrrdField* find(const std::string& name) const;
  // A field that must be there.
  const NrrdField& need(const std::string& name) const;
  // Throws Error{kBadInput} at a field's line.
  [[noreturn]] void fail(const NrrdField& field, const std::string& what, const std::string& remedy) const;
};

// Reads the header that begins where `bytes` stands, and nothing behind it; messages call it `path`. Throws
// Error{kBadInput} naming the line: no NRRD, a line or header over the limits, a field unknown or given twice, a line
// that is neither field, key/value nor comment.
NrrdFields readNrrdFields(ByteStream& bytes, const std::string& path);

// "(1,0,0)" as numbers; empty if it is none.
std::vector<double> nrrdVector(std::string_view word);

}  // namespace tet4d::exchange
