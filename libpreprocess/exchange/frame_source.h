// A sequence of frames of one grid, whatever file it comes from: the input of every builder that eats volumes.
//
// A source knows the grid and the times before the first sample is read; frames are then read one at a time, in any
// order, each into the caller's buffer. Nothing here holds more than one frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/sample_type.h"

namespace tet4d::exchange {

// The grid all frames share. Samples are x fastest, then y, then z.
struct GridInfo {
  std::array<std::uint64_t, 3> dims{};  // samples along x, y, z; each at least 1
  SampleType type = SampleType::kF32;   // as stored in the source
  AffineMap index_to_world;             // of sample positions: a cell-centred source's half cell is already in origin
  std::uint64_t voxels() const { return dims[0] * dims[1] * dims[2]; }
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const GridInfo& grid() const = 0;
  // World times, strictly increasing, one per frame (the count of frames is times().size()).
  virtual const std::vector<double>& times() const = 0;
  // Reads frame k into `samples`, native byte order, in the source's own type: exactly
  // grid().voxels() * sampleBytes(grid().type) bytes. Throws Error naming file and place.
  virtual void readFrame(std::size_t k, std::span<std::byte> samples) = 0;
  // What to call frame k in a message: its file, or "FILE frame k".
  virtual std::string frameName(std::size_t k) const = 0;
};

struct FrameSourceOptions {
  bool allow_gaps = false;    // accept a hole in the files' numbering
  std::vector<double> times;  // overrides the times of the files, if not empty
};

// Opens frames given on a command line: several 3D NRRD files (one a frame, in the order given), one directory (its
// *.nrrd/*.nhdr files in natural order), one 4D NRRD, one printf pattern (alpha_%04d.nrrd), or one .t4g.
// Throws Error: a file that is missing, short, of another size or type than the first, out of time order, or a hole in
// the numbering, each by name. Headers only are read here.
std::unique_ptr<FrameSource> openFrames(const std::vector<std::string>& inputs, const FrameSourceOptions& options = {});

}  // namespace tet4d::exchange
