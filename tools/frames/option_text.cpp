#include "tools/frames/option_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libpreprocess/error.h"

namespace tet4d::frames {
namespace {

[[noreturn]] void fail(const std::string& option, const std::string& text, const std::string& expected) {
  throw Error(FaultCode::kUsage, "", "option " + option, "'" + text + "' is not " + expected, "see --help");
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0;;) {
    const std::size_t end = text.find(separator, at);
    parts.push_back(text.substr(at, end - at));
    if (end == std::string_view::npos) return parts;
    at = end + 1;
  }
}

template <class T>
bool parse(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

template <class T>
std::array<T, 3> threeOf(const std::string& option, const std::string& text, bool one_for_all,
                         const std::string& expected) {
  const auto parts = split(text, ',');
  std::array<T, 3> values{};
  if (parts.size() != 3 && !(one_for_all && parts.size() == 1)) fail(option, text, expected);
  for (std::size_t c = 0; c < 3; ++c) {
    if (!parse(parts.size() == 1 ? parts[0] : parts[c], values[c])) fail(option, text, expected);
  }
  return values;
}

// "A:B", "A:", ":B" or ":".
bool parseRange(std::string_view first, std::string_view last, exchange::IndexRange& range) {
  return (first.empty() || parse(first, range.first)) && (last.empty() || parse(last, range.last));
}

}  // namespace

std::array<std::uint64_t, 3> countsOf(const std::string& option, const std::string& text, bool one_for_all) {
  return threeOf<std::uint64_t>(option, text, one_for_all,
                                one_for_all ? "a count N or counts X,Y,Z" : "counts X,Y,Z such as 64,64,32");
}

std::array<double, 3> numbersOf(const std::string& option, const std::string& text, bool one_for_all) {
  const std::string expected = one_for_all ? "a number or numbers X,Y,Z" : "numbers X,Y,Z such as 0,0.5,-1";
  const auto values = threeOf<double>(option, text, one_for_all, expected);
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    fail(option, text, expected);
  }
  return values;
}

std::array<exchange::IndexRange, 3> boxOf(const std::string& option, const std::string& text) {
  const std::string expected = "X0:X1,Y0:Y1,Z0:Z1 (samples, both ends included, counted from 0)";
  const auto parts = split(text, ',');
  std::array<exchange::IndexRange, 3> box;
  if (parts.size() != 3) fail(option, text, expected);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto ends = split(parts[c], ':');
    if (ends.size() != 2 || !parseRange(ends[0], ends[1], box[c])) fail(option, text, expected);
  }
  return box;
}

SteppedRange steppedRangeOf(const std::string& option, const std::string& text) {
  const auto parts = split(text, ':');
  SteppedRange range;
  const bool ok = (parts.size() == 2 || parts.size() == 3) && parseRange(parts[0], parts[1], range.range) &&
                  (parts.size() == 2 || (parse(parts[2], range.step) && range.step > 0));
  if (!ok) fail(option, text, "A:B or A:B:STEP (frames, both ends included, counted from 0)");
  return range;
}

std::vector<double> timesOf(const std::string& option, std::string_view text, const std::string& file) {
  std::vector<double> times;
  const auto isSeparator = [](char c) { return c == ',' || c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (isSeparator(*at)) {
      ++at;
      continue;
    }
    double time = 0;
    const auto [next, error] = std::from_chars(at, end, time);
    if (error != std::errc{} || (next != end && !isSeparator(*next))) {
      const std::string word(at, std::find_if(at, end, isSeparator));
      throw Error(file.empty() ? FaultCode::kUsage : FaultCode::kBadInput, file,
                  file.empty() ? "option " + option : "entry " + std::to_string(times.size() + 1),
                  "\"" + word + "\" is no number",
                  "give one world time a frame, or the name of a file that holds them");
    }
    times.push_back(time);
    at = next;
  }
  return times;
}

}  // namespace tet4d::frames
