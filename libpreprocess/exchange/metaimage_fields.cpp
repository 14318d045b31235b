#include "libpreprocess/exchange/metaimage_fields.h"

#include <cmath>

#include "libpreprocess/error.h"

namespace tet4d::exchange {

const MetaImageField* MetaImageFields::find(const std::string& key) const {
  const auto it = fields.find(key);
  return it == fields.end() ? nullptr : &it->second;
}

const MetaImageField* MetaImageFields::findAny(const std::vector<std::string>& keys) const {
  for (const std::string& key : keys) {
    if (const MetaImageField* field = find(key)) return field;
  }
  return nullptr;
}

const MetaImageField& MetaImageFields::need(const std::string& key) const {
  if (const MetaImageField* field = find(key)) return *field;
  throw Error(FaultCode::kBadInput, path, "header", "the key " + key + " is missing",
              "add \"" + key + " = …\" to the header");
}

void MetaImageFields::fail(const MetaImageField& field, const std::string& what, const std::string& remedy) const {
  throw Error(FaultCode::kBadInput, path, "line " + std::to_string(field.line), what, remedy);
}

std::vector<double> MetaImageFields::numbers(const MetaImageField& field, std::size_t count) const {
  std::vector<double> values;
  for (const std::string& word : wordsOf(field.text)) {
    const auto value = numberOf(word);
    if (!value || !std::isfinite(*value)) {
      fail(field, inQuotes(word) + " is no finite number", "correct \"" + field.key + "\"");
    }
    values.push_back(*value);
  }
  if (values.size() != count) {
    fail(field, field.key + " has " + std::to_string(values.size()) + " numbers, expected " + std::to_string(count),
         "correct \"" + field.key + "\" or \"NDims\"");
  }
  return values;
}

bool MetaImageFields::flag(const std::string& key, bool otherwise) const {
  const MetaImageField* field = find(key);
  if (field == nullptr) return otherwise;
  const char first = field->text.empty() ? '\0' : field->text[0];  // as MetaIO decides
  if (first == 'T' || first == 't' || first == '1') return true;
  if (first == 'F' || first == 'f' || first == '0') return false;
  fail(*field, key + " is " + inQuotes(field->text) + ", expected True or False", "correct \"" + key + "\"");
}

MetaImageFields readMetaImageFields(ByteStream& bytes, const std::string& path) {
  MetaImageFields header;
  header.path = path;
  LineReader lines(bytes, path, "MetaImage");
  const MetaImageField* last = nullptr;
  while (last == nullptr) {
    const auto line = lines.next();
    if (!line) {
      throw Error(FaultCode::kBadInput, path, "line " + std::to_string(lines.number()),
                  "the header ends without ElementDataFile, which is its last key", "copy or make the file again");
    }
    if (trimmed(*line).empty()) continue;
    const std::size_t equal = line->find('=');
    const MetaImageField field{std::string(trimmed(std::string_view(*line).substr(0, equal))),
                               equal == std::string::npos ? "" : std::string(trimmed(line->substr(equal + 1))),
                               lines.number()};
    if (equal == std::string::npos || field.key.empty()) {
      header.fail(field, "expected \"Key = value\", found " + inQuotes(*line), "give a MetaImage (.mha, .mhd)");
    }
    const auto [it, is_new] = header.fields.emplace(field.key, field);
    if (!is_new) header.fail(field, "the key " + inQuotes(field.key) + " is given twice", "keep one of them");
    if (field.key == "ElementDataFile") last = &it->second;
  }
  if (last->text.starts_with("LIST")) {
    while (const auto line = lines.next()) {
      if (const auto name = trimmed(*line); !name.empty()) header.listed_files.emplace_back(name);
    }
  }
  header.header_bytes = bytes.position();
  return header;
}

}  // namespace tet4d::exchange
