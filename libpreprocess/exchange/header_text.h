// What headers made of text have in common, whatever the format: lines, words, numbers, and how a message shows them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libpreprocess/exchange/byte_stream.h"

namespace tet4d::exchange {

// Limits against hostile headers.
inline constexpr std::size_t kMaxHeaderLineBytes = 1024 * 1024;
inline constexpr std::size_t kMaxHeaderBytes = 16 * 1024 * 1024;

// Lines of a stream from where it stands. Reads no byte behind the line it returns.
class LineReader {
 public:
  // `format` is named in messages: "NRRD".
  LineReader(ByteStream& bytes, std::string path, std::string format);

  std::size_t number() const { return number_; }  // of the line last returned, 1-based
  // The next line without its end; nothing at the end of the stream. A last line without an end counts as a line.
  // Throws Error{kBadInput} at a line or header over the limits.
  std::optional<std::string> next();

 private:
  ByteStream& bytes_;
  std::string path_, format_;
  std::uint64_t begin_;
  std::size_t number_ = 0;
};

// A text from a file as an error message shows it: in quotes, printable, not long.
std::string inQuotes(std::string_view text);
// Without blanks and line ends around it.
std::string_view trimmed(std::string_view text);
// The words of a text, divided by blanks; a text in quotes or parentheses is one word.
std::vector<std::string> wordsOf(std::string_view text);
// Whole words as numbers: no sign for counts, no rest, no overflow. Numbers may be nan or inf.
std::optional<std::uint64_t> countOf(std::string_view word);
std::optional<std::int64_t> integerOf(std::string_view word);
std::optional<double> numberOf(std::string_view word);

}  // namespace tet4d::exchange
