#include "formats/core/time_spec.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "formats/core/coordinates.h"

namespace tet4d {
namespace {

struct Value {
  double number;
  bool is_frame;  // had the suffix f
};

std::optional<Value> readValue(std::string_view text) {
  const bool is_frame = text.size() > 1 && text.back() == 'f';
  if (is_frame) text.remove_suffix(1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return Value{number, is_frame};
}

std::string shortText(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

Fault usage(std::string_view text, const std::string& what, const std::string& remedy) {
  return {FaultCode::kUsage, "", "time " + std::string(text.substr(0, 60)), what, remedy};
}

double lastFrame(std::span<const double> times) { return static_cast<double>(times.size() - 1); }

// Ends of the file's range, in the unit of `value`.
double rangeBegin(const Value& value, std::span<const double> times) { return value.is_frame ? 0 : times.front(); }
double rangeEnd(const Value& value, std::span<const double> times) {
  return value.is_frame ? lastFrame(times) : times.back();
}

SliceTime sliceTimeOf(const Value& value, std::span<const double> times) {
  const double number = std::clamp(value.number, rangeBegin(value, times), rangeEnd(value, times));
  if (value.is_frame) return {number, timeOfFrame(times, number)};
  return {frameOfTime(times, number), number};
}

Status checkRange(std::string_view text, const Value& value, std::span<const double> times) {
  const double begin = rangeBegin(value, times), end = rangeEnd(value, times);
  const double tolerance = 1e-9 * (end - begin);
  if (value.number >= begin - tolerance && value.number <= end + tolerance) return {};
  return usage(text, shortText(value.number) + (value.is_frame ? "f" : "") + " is outside the file's range",
               "choose from " + shortText(times.front()) + " to " + shortText(times.back()) + " (world), or 0f to " +
                   shortText(lastFrame(times)) + "f (frames)");
}

Fault noTime(std::string_view text) {
  return usage(text, "is no time", "write a world time (0.35), a frame (12.5f) or a range (A:B:STEP)");
}

// The times of "A:B:STEP". may_run_backward: STEP < 0 and A >= B are legal.
Result<std::vector<SliceTime>> parseRange(std::string_view text, std::span<const double> times, bool may_run_backward) {
  const std::size_t first_colon = text.find(':');
  const std::size_t second_colon = text.find(':', first_colon + 1);
  if (second_colon == std::string_view::npos) return noTime(text);
  const auto begin = readValue(text.substr(0, first_colon));
  const auto end = readValue(text.substr(first_colon + 1, second_colon - first_colon - 1));
  const auto step = readValue(text.substr(second_colon + 1));
  if (!begin || !end || !step) return noTime(text);
  if (begin->is_frame != end->is_frame || (step->is_frame && !begin->is_frame)) {
    return usage(text, "mixes frames and world times", "write the f behind both ends, or behind none");
  }
  const bool runs_backward = may_run_backward && step->number < 0;
  const double sign = runs_backward ? -1 : 1;
  if (!(sign * step->number > 0) || sign * (end->number - begin->number) < 0) {
    return usage(
        text, "the step must be over 0 and the end not before the beginning",
        may_run_backward ? "write A:B:STEP with A <= B, or A >= B and STEP < 0" : "write A:B:STEP with A <= B");
  }
  for (const Value& value : {*begin, *end}) {
    if (const Status status = checkRange(text, value, times); !status.ok()) return status.fault();
  }
  const double steps = std::floor((end->number - begin->number) / step->number + 1e-9);
  if (!(steps < static_cast<double>(kMaxTimes))) {
    return usage(text, "holds over " + std::to_string(kMaxTimes) + " times", "choose a longer step");
  }
  std::vector<SliceTime> result;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(steps); ++k) {
    const double number = begin->number + static_cast<double>(k) * step->number;
    // The sum may miss the end by a rounding; what the user wrote is meant.
    const bool is_end = std::abs(number - end->number) <= 1e-9 * std::abs(step->number);
    result.push_back(sliceTimeOf({is_end ? end->number : number, begin->is_frame}, times));
  }
  return result;
}

}  // namespace

Result<SliceTime> parseTime(std::string_view text, std::span<const double> times) {
  const auto value = readValue(text);
  if (!value) return noTime(text);
  if (const Status status = checkRange(text, *value, times); !status.ok()) return status.fault();
  return sliceTimeOf(*value, times);
}

Result<std::vector<SliceTime>> parseTimes(std::string_view text, std::span<const double> times) {
  if (text.find(':') != std::string_view::npos) return parseRange(text, times, false);
  auto single = parseTime(text, times);
  if (!single.ok()) return single.fault();
  return std::vector<SliceTime>{single.value()};
}

Result<std::vector<SliceTime>> parseTimeList(std::string_view text, std::span<const double> times) {
  std::vector<SliceTime> all;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view part = text.substr(begin, comma - begin);
    auto some = part.find(':') != std::string_view::npos ? parseRange(part, times, true) : parseTimes(part, times);
    if (!some.ok()) return some.fault();
    all.insert(all.end(), some.value().begin(), some.value().end());
    if (all.size() > kMaxTimes)
      return usage(text, "holds over " + std::to_string(kMaxTimes) + " times", "choose fewer");
    begin = comma + 1;
  }
  return all;
}

}  // namespace tet4d
