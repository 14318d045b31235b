#include "libpreprocess/exchange/header_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

LineReader::LineReader(ByteStream& bytes, std::string path, std::string format)
    : bytes_(bytes), path_(std::move(path)), format_(std::move(format)), begin_(bytes.position()) {}

std::optional<std::string> LineReader::next() {
  std::string line;
  const auto fail = [&](const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kBadInput, path_, "line " + std::to_string(number_), what, remedy);
  };
  for (bool ended = false; !ended;) {
    const std::span<const std::byte> here = bytes_.peek();
    if (here.empty() && line.empty()) return std::nullopt;
    const std::string_view text(reinterpret_cast<const char*>(here.data()), here.size());
    const std::size_t end = text.find('\n');
    ended = here.empty() || end != std::string_view::npos;
    if (line.empty()) ++number_;
    line.append(text.substr(0, end));
    bytes_.consume(end == std::string_view::npos ? text.size() : end + 1);
    if (line.size() > kMaxHeaderLineBytes) {
      fail("the header's line is longer than " + std::to_string(kMaxHeaderLineBytes) + " bytes",
           "check that this is a " + format_ + " file");
    }
  }
  if (bytes_.position() - begin_ > kMaxHeaderBytes) {
    fail("the header is longer than " + std::to_string(kMaxHeaderBytes) + " bytes",
         "check that this is a " + format_ + " file, and that its header ends");
  }
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

std::string inQuotes(std::string_view text) {
  std::string out(1, '"');
  for (const char c : text.substr(0, 60)) out += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  if (text.size() > 60) out += "…";
  out += '"';
  return out;
}

std::vector<std::string> wordsOf(std::string_view text) {
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

std::optional<std::uint64_t> countOf(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> integerOf(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<double> numberOf(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace tet4d::exchange
