// The files of a sequence by their names: patterns, natural order, holes in the numbering. No file is opened here.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tet4d::exchange {

// "frame2" before "frame10": runs of digits compare as numbers, everything else by bytes.
bool naturalLess(const std::string& a, const std::string& b);

// The files of a directory that have a frame format's suffix, or (`raw`) that of a raw file, in natural order. Throws
// Error if there are none, files of two formats, or it cannot be read.
std::vector<std::string> filesOfDirectory(const std::string& directory, bool raw = false);

// The same for other suffixes: those for which format_of() is not empty. `suffixes`: what to call them.
std::vector<std::string> filesOfDirectory(const std::string& directory,
                                          const std::function<std::string(const std::string&)>& format_of,
                                          const std::string& suffixes);

// The files that match a printf pattern (path with one %d …), by number. Throws Error if there are none.
std::vector<std::string> filesOfPattern(const std::string& pattern);

// The numbers of files whose names differ in one number only, in the files' order; nothing for other names.
std::optional<std::vector<std::int64_t>> fileNumbers(const std::vector<std::string>& files);

// True if the numbers grow by multiples of the smallest distance, at least two of them.
bool hasCommonStep(const std::vector<std::int64_t>& numbers);

// Proves that the numbers grow by one step. Throws Error{kBadInput} that names a missing number, or the two files whose
// numbers do not grow, or numbers without a common step. allow_gaps accepts all but falling numbers.
void checkNumbering(const std::vector<std::string>& files, const std::vector<std::int64_t>& numbers, bool allow_gaps);

}  // namespace tet4d::exchange
