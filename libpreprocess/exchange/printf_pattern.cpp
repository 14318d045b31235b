#include "libpreprocess/exchange/printf_pattern.h"

#include <charconv>

namespace tet4d::exchange {

std::optional<NumberPattern> NumberPattern::parse(std::string_view text) {
  NumberPattern pattern;
  bool found = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& part = found ? pattern.suffix : pattern.prefix;
    if (text[i] != '%') {
      part += text[i];
      continue;
    }
    if (i + 1 < text.size() && text[i + 1] == '%') {
      part += text[++i];
      continue;
    }
    if (found) return std::nullopt;
    std::size_t end = i + 1;
    if (end < text.size() && text[end] == '0') pattern.zeros = true;
    while (end < text.size() && text[end] >= '0' && text[end] <= '9' && pattern.width <= 20) {
      pattern.width = pattern.width * 10 + static_cast<std::size_t>(text[end++] - '0');
    }
    if (pattern.width > 20 || end >= text.size()) return std::nullopt;
    if (text[end] != 'd' && text[end] != 'i' && text[end] != 'u') return std::nullopt;
    found = true;
    i = end;
  }
  return found ? std::optional(pattern) : std::nullopt;
}

std::string NumberPattern::name(std::int64_t number) const {
  std::string digits = std::to_string(number);
  const bool negative = digits[0] == '-';
  if (digits.size() < width && zeros) digits.insert(negative ? 1 : 0, width - digits.size(), '0');
  if (digits.size() < width) digits.insert(0, width - digits.size(), ' ');
  return prefix + digits + suffix;
}

std::optional<std::int64_t> NumberPattern::numberOf(std::string_view text) const {
  if (text.size() <= prefix.size() + suffix.size() || !text.starts_with(prefix) || !text.ends_with(suffix)) {
    return std::nullopt;
  }
  std::string_view digits = text.substr(prefix.size(), text.size() - prefix.size() - suffix.size());
  while (digits.size() > 1 && digits.front() == ' ') digits.remove_prefix(1);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc{} || end != digits.data() + digits.size() || name(number) != text) return std::nullopt;
  return number;
}

}  // namespace tet4d::exchange
