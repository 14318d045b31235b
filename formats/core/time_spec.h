// Times as a user writes them, against a file's table of times: world times ("0.35"), or frame numbers with the suffix
// f
// ("12.5f"); ranges "A:B:STEP" with both ends included.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "formats/core/result.h"

namespace tet4d {

// A time to slice at, in both units. The one the user wrote is exact; the other follows from the table.
struct SliceTime {
  double frame;  // 0 … times.size() - 1
  double time;   // world
};

// The most times one range may hold.
inline constexpr std::size_t kMaxTimes = 10'000'000;

// One time. times: the file's table, strictly increasing, at least one. Faults are kUsage: no number, or outside the
// file's range, which is named. What lies outside by no more than 1e-9 of the range counts as its end.
Result<SliceTime> parseTime(std::string_view text, std::span<const double> times);

// "T" (one time) or "A:B:STEP": A, A + STEP, … up to B, which is included if it is within 1e-9 STEP of one of them. A
// and B are of one kind (both with f or both without); STEP may leave the f out. STEP > 0, A <= B.
Result<std::vector<SliceTime>> parseTimes(std::string_view text, std::span<const double> times);

// Times in any order, for programs that jump: a list "T,A:B:STEP,…" of what parseTimes() takes; a range may also run
// backward, with A >= B and STEP < 0. At most kMaxTimes in all.
Result<std::vector<SliceTime>> parseTimeList(std::string_view text, std::span<const double> times);

}  // namespace tet4d
