// Texts of frame options as values. Each throws Error{kUsage} that names the option and the text.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libpreprocess/exchange/frame_view.h"

namespace tet4d::frames {

// "64,32,16": counts; with `one_for_all` "2" is "2,2,2".
std::array<std::uint64_t, 3> countsOf(const std::string& option, const std::string& text, bool one_for_all);
// "0.5,0.5,1" or, with `one_for_all`, "0.5": finite numbers.
std::array<double, 3> numbersOf(const std::string& option, const std::string& text, bool one_for_all);
// "X0:X1,Y0:Y1,Z0:Z1"; an end left out is the grid's.
std::array<exchange::IndexRange, 3> boxOf(const std::string& option, const std::string& text);
// "A:B" or "A:B:STEP" (STEP at least 1); an end left out is the sequence's.
struct SteppedRange {
  exchange::IndexRange range;
  std::uint64_t step = 1;
};
SteppedRange steppedRangeOf(const std::string& option, const std::string& text);
// Numbers divided by commas or white space; of a file (`file` not empty) they are Error{kBadInput} naming it.
std::vector<double> timesOf(const std::string& option, std::string_view text, const std::string& file);

}  // namespace tet4d::frames
