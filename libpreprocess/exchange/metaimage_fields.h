// The text of a MetaImage header as keys and values, before any of it is understood.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libpreprocess/exchange/header_text.h"

namespace tet4d::exchange {

struct MetaImageField {
  std::string key, text;  // text trimmed
  std::size_t line = 0;   // 1-based
};

struct MetaImageFields {
  std::string path;
  std::map<std::string, MetaImageField> fields;  // by key; each at most once
  std::vector<std::string> listed_files;         // lines after "ElementDataFile = LIST"
  std::uint64_t header_bytes = 0;                // where local data begin

  const MetaImageField* find(const std::string& key) const;
  // The first of the keys that is there, for keys with older names.
  const MetaImageField* findAny(const std::vector<std::string>& keys) const;
  // A key that must be there.
  const MetaImageField& need(const std::string& key) const;
  // Throws Error{kBadInput} at a field's line.
  [[noreturn]] void fail(const MetaImageField& field, const std::string& what, const std::string& remedy) const;

  // The values of a field, exactly `count`, finite.
  std::vector<double> numbers(const MetaImageField& field, std::size_t count) const;
  bool flag(const std::string& key, bool otherwise) const;
};

// Reads the header that begins where `bytes` stands, up to its last key, ElementDataFile. Throws Error{kBadInput}
// naming the line: no MetaImage, a line or header over the limits, a key given twice, a line without "=".
MetaImageFields readMetaImageFields(ByteStream& bytes, const std::string& path);

}  // namespace tet4d::exchange
