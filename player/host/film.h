// Where the frames of a film go: numbered PNG files, or one y4m stream.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "formats/core/result.h"
#include "player/render/image.h"

namespace tet4d::host {

class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Frames come in order, all of one size.
  virtual Status add(const render::Image& image) = 0;
  // After the last frame. Without it an unfinished film leaves nothing under its final name.
  virtual Status finish() = 0;
};

// The name of frame `number`: `pattern` with its one %d or %0Nd replaced; %% is a percent sign. Fault (kUsage) for
// another use of %, or more than one number.
Result<std::string> frameName(const std::string& pattern, std::size_t number);
// True if the pattern has a place for the number.
bool hasNumber(const std::string& pattern);

// One PNG a frame, numbered from 0. Checks before anything is drawn that no frame's file exists (unless `force`); more
// than one frame needs a pattern with a number.
Result<std::unique_ptr<FrameSink>> makePngFrames(const std::string& pattern, std::size_t frames, bool force);

// Uncompressed film, YUV4MPEG2 with C420jpeg (chroma between the four pixels), limited range, BT.601. `path` "-" is
// standard output. fps > 0, kept to 1/1000. Frames of odd size have chroma planes rounded up.
Result<std::unique_ptr<FrameSink>> makeY4mFilm(const std::string& path, double fps, bool force);

}  // namespace tet4d::host
