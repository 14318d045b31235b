// Frame files as sequences: one file a frame, or all frames in one file. Which files, and in which order, is decided
// before (open_frames, or a format's own list of files).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libpreprocess/exchange/frame_source.h"

namespace tet4d::exchange {

// Files of one frame each, in the order given; all of one grid and type, and their times growing. Headers stay in
// memory, one data file is open at a time. Throws Error naming the file.
std::unique_ptr<FrameSource> openFileSeries(const std::vector<std::string>& names, const FrameSourceOptions& options);

// All frames of one file.
std::unique_ptr<FrameSource> openFileMovie(std::unique_ptr<FrameFile> file, const FrameSourceOptions& options);

// Proves that a frame's grid is that of the first, up to the digits of a decimal text. Throws Error{kBadInput} naming
// both.
void checkSameGrid(const std::string& first_name, const GridInfo& first, const std::string& other_name,
                   const GridInfo& other);

// Frame numbers as times: 0, 1, 2 … and, where a hole in the files' numbers was accepted, further apart.
std::vector<double> countedTimes(std::size_t frames, const std::optional<std::vector<std::int64_t>>& numbers);

// Proves that times given by the caller are as many as frames and growing. Throws Error{kUsage}.
void checkGivenTimes(const std::vector<double>& times, std::size_t frames);

}  // namespace tet4d::exchange
