// A part of a sequence as a sequence: a box of samples, every n-th of them, some of the frames.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "libpreprocess/exchange/frame_source.h"

namespace tet4d::exchange {

// First to last, both included.
struct IndexRange {
  std::uint64_t first = 0;
  std::uint64_t last = std::numeric_limits<std::uint64_t>::max();  // this: to the end
};

struct FrameViewOptions {
  std::optional<std::array<IndexRange, 3>> crop;  // samples along x, y, z
  std::array<std::uint64_t, 3> stride{1, 1, 1};   // every n-th sample, from the first of the box on
  IndexRange frames;                              // of the source
  std::uint64_t frame_step = 1;                   // every n-th of them

  bool isWhole() const;  // nothing is left out
};

// The part of `source`: its grid, positions and times are those of the samples and frames that are left. Works on
// streams too, whose frames past frames.last are not waited for. Holds one layer of the source; reads no layer that is
// left out, but for what a compressed file or a stream has to pass over. Throws Error{kUsage} naming the range: beyond
// the samples or frames there are (a stream's missing frames show at its end), or empty.
std::unique_ptr<FrameSource> viewFrames(std::unique_ptr<FrameSource> source, const FrameViewOptions& options);

}  // namespace tet4d::exchange
