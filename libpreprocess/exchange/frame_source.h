// A sequence of frames of one grid, whatever file it comes from: the input of every builder that eats volumes.
//
// A source knows the grid before the first sample is read, and the times too unless it is a stream. Frames are read one
// at a time, layer by layer, into the caller's buffer. Nothing here holds a frame, but for formats that say so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libpreprocess/exchange/frame_file.h"

namespace tet4d::exchange {

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const GridInfo& grid() const = 0;
  // World times, strictly increasing, one per frame: of all frames from the start, or of those known so far of a
  // stream.
  virtual const std::vector<double>& times() const = 0;
  // Whether frames come in order, each once, and their count is known only at the end.
  virtual bool isStream() const { return false; }
  // Whether there is a frame k. A stream waits for its next header; what was not read of the frames before is lost.
  virtual bool hasFrame(std::size_t k) { return k < times().size(); }
  // Reads layers [z_begin, z_end) of frame k into `samples`, native byte order, in the source's own type: exactly
  // (z_end - z_begin) * grid().layerBytes() bytes. Frames in any order, unless it is a stream; the layers of one in
  // growing order. Throws Error naming file and place.
  virtual void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) = 0;
  // What to call frame k in a message: its file, or "FILE frame k".
  virtual std::string frameName(std::size_t k) const = 0;

  // All layers of frame k: grid().frameBytes() bytes.
  void readFrame(std::size_t k, std::span<std::byte> samples) { readLayers(k, 0, grid().dims[2], samples); }
};

struct FrameSourceOptions {
  bool allow_gaps = false;    // accept a hole in the files' numbering
  std::vector<double> times;  // overrides the times of the files, if not empty
  FrameFileOptions file;      // what the files do not tell of themselves
};

// Opens frames given on a command line: several files of one frame each (in the order given), one directory (its
// files of a known format in natural order), one file of many frames, one printf pattern (alpha_%04d.nrrd), one .pvd
// series of .vti, one .t4g, or "-" for frames from standard input (frame_stream.h). Throws Error: a file that is
// missing, short, of another size or type than the first, out of time order, or a hole in the numbering, each by name.
// Headers only are read here.
std::unique_ptr<FrameSource> openFrames(const std::vector<std::string>& inputs, const FrameSourceOptions& options = {});

}  // namespace tet4d::exchange
