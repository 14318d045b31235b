#include "tools/common/bindings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

#include "libpreprocess/error.h"

namespace tet4d::cli {

namespace {

using nlohmann::ordered_json;

// Where a text came from, for messages.
struct Source {
  const std::string& shown;
  const std::string& text;
  bool may_be_infinite = false;

  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(FaultCode::kUsage, {}, shown, fmt::format("'{}' is not {}", text, expected), "see --help");
  }
};

template <class T>
bool parseNumber(std::string_view text, T& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

double toDouble(const Source& source, std::string_view text) {
  double value = 0;
  if (!parseNumber(text, value)) source.fail("a number");
  if (!std::isfinite(value) && !source.may_be_infinite) source.fail("a finite number");
  return value;
}

bool toFlag(const Source& source) {
  for (const char* yes : {"true", "1", "on", "yes"}) {
    if (source.text == yes) return true;
  }
  for (const char* no : {"false", "0", "off", "no"}) {
    if (source.text == no) return false;
  }
  source.fail("true or false");
}

std::uint64_t toCount(const Source& source) {
  std::uint64_t value = 0;
  if (!parseNumber<std::uint64_t>(source.text, value)) source.fail("a whole number of at least 0");
  return value;
}

std::uint64_t toSize(const Source& source) {
  static constexpr const char* kExpected = "a size such as 512M, 1.5GiB or 2000000";
  const std::size_t digits = source.text.find_first_not_of("0123456789.");
  const std::string_view number = std::string_view(source.text).substr(0, digits);
  const std::string_view unit =
      digits == std::string::npos ? std::string_view() : std::string_view(source.text).substr(digits);
  double value = 0;
  if (!parseNumber(number, value)) source.fail(kExpected);
  double factor = 1;
  if (!unit.empty() && unit != "B") {
    const std::size_t power = std::string_view("KMGT").find(unit.front() == 'k' ? 'K' : unit.front());
    const std::string_view rest = unit.substr(1);
    if (power == std::string_view::npos || !(rest.empty() || rest == "iB" || rest == "B")) source.fail(kExpected);
    factor = std::pow(rest == "B" ? 1000.0 : 1024.0, static_cast<double>(power + 1));
  }
  const double bytes = value * factor;
  if (!(bytes < 9.0e18)) source.fail("a size a machine could have");
  return static_cast<std::uint64_t>(std::ceil(bytes));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::vector<double> toNumbers(const Source& source) {
  std::vector<double> values;
  for (const std::string_view part : split(source.text, ',')) values.push_back(toDouble(source, part));
  return values;
}

std::vector<double> toTimes(const Source& source) {
  const std::vector<std::string_view> parts = split(source.text, ':');
  if (parts.size() == 1) return toNumbers(source);
  if (parts.size() != 3) source.fail("T, T,T,T or A:B:STEP");
  const double first = toDouble(source, parts[0]), last = toDouble(source, parts[1]), step = toDouble(source, parts[2]);
  constexpr double kMostTimes = 1e8;
  if (!std::isfinite(first) || !std::isfinite(last) || !(step > 0) || last < first ||
      !((last - first) / step < kMostTimes)) {
    source.fail("A:B:STEP with A <= B, STEP > 0 and fewer than 1e8 times");
  }
  // Each time is computed from its rank, so that no rounding adds up; a last one that all but meets B becomes B.
  const double slack = 1e-6;
  const auto steps = static_cast<std::uint64_t>(std::floor((last - first) / step + slack));
  std::vector<double> times;
  for (std::uint64_t k = 0; k <= steps; ++k) times.push_back(first + static_cast<double>(k) * step);
  if (std::abs(times.back() - last) <= slack * step) times.back() = last;
  return times;
}

std::array<std::uint32_t, 2> toExtent(const Source& source) {
  const std::vector<std::string_view> parts = split(source.text, 'x');
  std::array<std::uint32_t, 2> extent{};
  if (parts.size() != 2 || !parseNumber(parts[0], extent[0]) || !parseNumber(parts[1], extent[1]) || extent[0] == 0 ||
      extent[1] == 0) {
    source.fail("WxH, such as 1280x720");
  }
  return extent;
}

void assignChoice(const Choice& choice, const Source& source) {
  for (const std::string& word : choice.words) {
    if (word == source.text) {
      *choice.value = word;
      return;
    }
  }
  const std::string meant = nearest(source.text, choice.words);
  throw Error(FaultCode::kUsage, {}, source.shown,
              fmt::format("'{}' is not one of {}", source.text, fmt::join(choice.words, ", ")),
              meant.empty() ? "see --help" : fmt::format("did you mean '{}'?", meant));
}

// One branch per kind of binding.
template <class... Branches>
struct Overloaded : Branches... {
  using Branches::operator()...;
};
template <class... Branches>
Overloaded(Branches...) -> Overloaded<Branches...>;

}  // namespace

void assign(const Option& option, const std::string& shown, const std::vector<std::string>& texts) {
  const Source source{shown, texts.back(), (option.traits & kMayBeInfinite) != 0};
  std::visit(Overloaded{
                 [&](bool* value) { *value = toFlag(source); },
                 [&](std::string* value) { *value = source.text; },
                 [&](double* value) { *value = toDouble(source, source.text); },
                 [&](std::optional<double>* value) { *value = toDouble(source, source.text); },
                 [&](std::uint64_t* value) { *value = toCount(source); },
                 [&](std::optional<std::uint64_t>* value) { *value = toCount(source); },
                 [&](std::vector<std::string>* value) { *value = texts; },
                 [&](std::vector<double>* value) { *value = toNumbers(source); },
                 [&](const Size& size) { *size.value = toSize(source); },
                 [&](const Choice& choice) { assignChoice(choice, source); },
                 [&](const Times& times) { *times.value = toTimes(source); },
                 [&](const Extent& extent) { *extent.value = toExtent(source); },
             },
             option.binding);
}

nlohmann::ordered_json valueOf(const Binding& binding) {
  return std::visit(Overloaded{
                        [](const Size& size) { return ordered_json(*size.value); },
                        [](const Choice& choice) { return ordered_json(*choice.value); },
                        [](const Times& times) { return ordered_json(*times.value); },
                        [](const Extent& extent) { return ordered_json(*extent.value); },
                        [](const auto* value) {
                          if constexpr (requires { value->has_value(); }) {
                            return value->has_value() ? ordered_json(**value) : ordered_json(nullptr);
                          } else {
                            return ordered_json(*value);
                          }
                        },
                    },
                    binding);
}

std::string defaultText(const Binding& binding) {
  if (const auto* extent = std::get_if<Extent>(&binding)) {
    const auto& [width, height] = *extent->value;
    return width == 0 ? std::string() : fmt::format("{}x{}", width, height);
  }
  const ordered_json value = valueOf(binding);
  if (value.is_string()) return value.get<std::string>();
  // A size of 0 stands for "no limit", which its help text says in words.
  if (std::holds_alternative<Size>(binding) && value == 0) return {};
  return value.is_number() ? value.dump() : std::string();
}

std::string choicesText(const Binding& binding) {
  const auto* choice = std::get_if<Choice>(&binding);
  return choice == nullptr ? std::string() : fmt::format("{}", fmt::join(choice->words, "|"));
}

bool takesMany(const Binding& binding) { return std::holds_alternative<std::vector<std::string>*>(binding); }

}  // namespace tet4d::cli
