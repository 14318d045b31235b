#include "libpreprocess/exchange/nrrd_fields.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

// Every field of the format, and the spellings the format allows beside the first.
constexpr std::array<std::array<std::string_view, 3>, 30> kFieldNames{{
    {"content"},
    {"number"},
    {"type"},
    {"block size", "blocksize"},
    {"dimension"},
    {"space"},
    {"space dimension", "spacedimension"},
    {"sizes"},
    {"spacings"},
    {"thicknesses"},
    {"axis mins", "axismins"},
    {"axis maxs", "axismaxs"},
    {"centerings", "centers"},
    {"labels"},
    {"units"},
    {"min"},
    {"max"},
    {"old min", "oldmin"},
    {"old max", "oldmax"},
    {"data file", "datafile"},
    {"endian"},
    {"encoding"},
    {"line skip", "lineskip"},
    {"byte skip", "byteskip"},
    {"sample units", "sampleunits"},
    {"space units", "spaceunits"},
    {"space origin", "spaceorigin"},
    {"space directions", "spacedirections"},
    {"measurement frame", "measurementframe"},
    {"kinds"},
}};

std::string fieldName(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& names : kFieldNames) {
    if (std::find(names.begin(), names.end(), lower) != names.end() && !lower.empty()) return std::string(names[0]);
  }
  return {};
}

std::string unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'n' || text[i + 1] == '\\')) {
      out += text[++i] == 'n' ? '\n' : '\\';
    } else {
      out += text[i];
    }
  }
  return out;
}

[[noreturn]] void failLine(const NrrdFields& header, std::size_t line, const std::string& what,
                           const std::string& remedy) {
  throw Error(FaultCode::kBadInput, header.path, "line " + std::to_string(line), what, remedy);
}

void readMagic(LineReader& lines, NrrdFields& header) {
  const auto first = lines.next();
  const bool ok =
      first && first->size() == 8 && first->starts_with("NRRD000") && (*first)[7] >= '1' && (*first)[7] <= '5';
  if (!ok) {
    failLine(header, 1, "expected NRRD0001 … NRRD0005, found " + inQuotes(first.value_or(std::string())),
             "give a NRRD file (.nrrd, .nhdr)");
  }
  header.version = (*first)[7] - '0';
}

// One line of the header after the magic. Returns true after "data file: LIST", which ends it.
bool readLine(const std::string& line, std::size_t number, NrrdFields& header) {
  if (line[0] == '#') return false;
  const std::size_t pair = line.find(":=");
  std::size_t colon = line.find(": ");
  if (colon == std::string::npos && line.back() == ':') colon = line.size() - 1;  // an empty value, its blank trimmed
  if (pair != std::string::npos && (colon == std::string::npos || pair < colon)) {
    const std::string key = unescaped(std::string_view(line).substr(0, pair));
    if (!header.key_values.emplace(key, unescaped(std::string_view(line).substr(pair + 2))).second) {
      failLine(header, number, "the key " + inQuotes(key) + " is given twice", "keep one of them");
    }
    return false;
  }
  if (colon == std::string::npos) {
    failLine(header, number, "expected \"field: value\", \"key:=value\" or a comment, found " + inQuotes(line),
             "correct the line, or end the header with an empty line");
  }
  const std::string name = fieldName(std::string_view(line).substr(0, colon));
  if (name.empty()) {
    failLine(header, number, "no field of NRRD is called " + inQuotes(std::string_view(line).substr(0, colon)),
             "correct the name, or write \"key:=value\"");
  }
  const std::string_view text = trimmed(std::string_view(line).substr(colon + 1));
  if (!header.fields.emplace(name, NrrdField{std::string(text), number}).second) {
    failLine(header, number, "the field \"" + name + "\" is given twice", "keep one of them");
  }
  return name == "data file" && text.starts_with("LIST");
}

}  // namespace

const NrrdField* NrrdFields::find(const std::string& name) const {
  const auto it = fields.find(name);
  return it == fields.end() ? nullptr : &it->second;
}

const NrrdField& NrrdFields::need(const std::string& name) const {
  if (const NrrdField* field = find(name)) return *field;
  throw Error(FaultCode::kBadInput, path, "header", "the field \"" + name + "\" is missing",
              "add \"" + name + ": …\" to the header");
}

void NrrdFields::fail(const NrrdField& field, const std::string& what, const std::string& remedy) const {
  failLine(*this, field.line, what, remedy);
}

NrrdFields readNrrdFields(ByteStream& bytes, const std::string& path) {
  NrrdFields header;
  header.path = path;
  LineReader lines(bytes, path, "NRRD");
  readMagic(lines, header);
  bool in_list = false;
  while (const auto line = lines.next()) {
    if (in_list) {
      if (const auto name = trimmed(*line); !name.empty()) header.listed_files.emplace_back(name);
      continue;
    }
    if (line->empty()) break;
    in_list = readLine(*line, lines.number(), header);
  }
  header.header_bytes = bytes.position();
  return header;
}

std::vector<double> nrrdVector(std::string_view word) {
  if (word.size() < 2 || word.front() != '(' || word.back() != ')') return {};
  word = word.substr(1, word.size() - 2);
  std::vector<double> numbers;
  while (numbers.size() <= kMaxNrrdDimension) {
    const std::size_t comma = word.find(',');
    const auto number = numberOf(trimmed(word.substr(0, comma)));
    if (!number) return {};
    numbers.push_back(*number);
    if (comma == std::string_view::npos) return numbers;
    word.remove_prefix(comma + 1);
  }
  return {};
}

}  // namespace tet4d::exchange
