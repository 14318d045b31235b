// File names made from numbers: a pattern with one %d, %4d or %04d (also i, u), and nothing else of printf.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tet4d::exchange {

struct NumberPattern {
  std::string prefix, suffix;
  std::size_t width = 0;  // least count of characters, at most 20
  bool zeros = false;     // padded with zeros, else blanks

  // The pattern in `text`; nothing if there is none or anything beside one number is asked for. "%%" stands for %.
  static std::optional<NumberPattern> parse(std::string_view text);
  std::string name(std::int64_t number) const;
  // The number whose name this is.
  std::optional<std::int64_t> numberOf(std::string_view name) const;
};

}  // namespace tet4d::exchange
