// Frames that come through a pipe while a simulation makes them.
#pragma once

#include <memory>
#include <string>

#include "libpreprocess/exchange/frame_source.h"

namespace tet4d::exchange {

// Frames of an open descriptor, which stays the caller's: NRRDs with attached headers behind each other (raw, or a gzip
// member each; `time:=T` in all or none; 4D ones bring many frames), or with options.file.raw raw frames behind each
// other, after RawLayout::skip bytes once. options.times are as many as the frames; a stream of more or fewer is an
// error where that is seen. Waits for the first header. Holds one header and a fixed buffer, no frame.
//
// Throws Error{kBadInput} naming the frame: no frames at all, a truncated last frame (with the bytes it has and needs),
// another grid than the first frame's, times that do not grow, data in other files.
std::unique_ptr<FrameSource> openFrameStream(int descriptor, const std::string& name,
                                             const FrameSourceOptions& options);

}  // namespace tet4d::exchange
