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

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

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

// Lines of a file from the front, through one fixed buffer.
class LineReader {
 public:
  explicit LineReader(const InputFile& file) : file_(file), buffer_(4096) {}

  std::size_t number() const { return number_; }             // of the line last returned, 1-based
  std::uint64_t position() const { return begin_ + used_; }  // after it
  // The next line without its end; nothing at the end of the file. A last line without an end counts as a line.
  std::optional<std::string> next() {
    std::string_view rest = std::string_view(buffer_.data(), filled_).substr(used_);
    if (rest.find('\n') == std::string_view::npos) rest = refill();
    if (rest.empty()) return std::nullopt;
    ++number_;
    const std::size_t end = rest.find('\n');
    const std::size_t length = std::min(end, rest.size());
    if (length > kMaxNrrdLineBytes) {
      throw Error(FaultCode::kBadInput, file_.path(), "line " + std::to_string(number_),
                  "the header's line is longer than " + std::to_string(kMaxNrrdLineBytes) + " bytes",
                  "check that this is a NRRD file");
    }
    used_ += length + (end == std::string_view::npos ? 0 : 1);
    if (position() > kMaxNrrdHeaderBytes) {
      throw Error(FaultCode::kBadInput, file_.path(), "line " + std::to_string(number_),
                  "the header is longer than " + std::to_string(kMaxNrrdHeaderBytes) + " bytes",
                  "check that the header ends with an empty line");
    }
    std::string line(rest.substr(0, length));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  }

 private:
  // Moves the buffer on to the line that begins at position(); what of it is in the file.
  std::string_view refill() {
    begin_ += used_;
    used_ = 0;
    for (;;) {
      filled_ = file_.readSome(begin_, std::as_writable_bytes(std::span(buffer_)));
      const std::string_view rest(buffer_.data(), filled_);
      const bool complete = filled_ < buffer_.size() || rest.find('\n') != std::string_view::npos;
      if (complete || buffer_.size() > kMaxNrrdLineBytes) return rest;
      buffer_.resize(buffer_.size() * 2);
    }
  }

  const InputFile& file_;
  std::vector<char> buffer_;
  std::uint64_t begin_ = 0;  // of the buffer in the file
  std::size_t used_ = 0, filled_ = 0;
  std::size_t number_ = 0;
};

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

NrrdFields readNrrdFields(const InputFile& file) {
  NrrdFields header;
  header.path = file.path();
  LineReader lines(file);
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
  header.header_bytes = lines.position();
  return header;
}

std::string inQuotes(std::string_view text) {
  std::string out(1, '"');
  for (const char c : text.substr(0, 60)) out += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  if (text.size() > 60) out += "…";
  out += '"';
  return out;
}

std::vector<std::string> nrrdWords(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < text.size();) {
    if (isBlank(text[i])) {
      ++i;
      continue;
    }
    const char close = text[i] == '"' ? '"' : text[i] == '(' ? ')' : '\0';
    std::size_t end = i + 1;
    if (close != '\0') {
      end = std::min(text.find(close, i + 1), text.size() - 1) + 1;
      words.emplace_back(close == ')' ? text.substr(i, end - i) : text.substr(i + 1, end - i - 1));
      if (close == '"' && !words.back().empty() && words.back().back() == '"') words.back().pop_back();
    } else {
      while (end < text.size() && !isBlank(text[end]) && text[end] != '(') ++end;
      words.emplace_back(text.substr(i, end - i));
    }
    i = end;
  }
  return words;
}

std::optional<std::uint64_t> nrrdCount(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> nrrdInteger(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<double> nrrdNumber(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::vector<double> nrrdVector(std::string_view word) {
  if (word.size() < 2 || word.front() != '(' || word.back() != ')') return {};
  word = word.substr(1, word.size() - 2);
  std::vector<double> numbers;
  while (numbers.size() <= kMaxNrrdDimension) {
    const std::size_t comma = word.find(',');
    const auto number = nrrdNumber(trimmed(word.substr(0, comma)));
    if (!number) return {};
    numbers.push_back(*number);
    if (comma == std::string_view::npos) return numbers;
    word.remove_prefix(comma + 1);
  }
  return {};
}

}  // namespace tet4d::exchange
