// One file of frames, whatever its format: a header that is proved when the file is opened, and samples read layer by
// layer. `frame_source.h` makes sequences of these.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/sample_type.h"

namespace tet4d::exchange {

// More frames than this would not be exact as float32 frame numbers.
inline constexpr std::uint64_t kMaxFrames = std::uint64_t{1} << 24;

// The grid all frames share. Samples are x fastest, then y, then z.
struct GridInfo {
  std::array<std::uint64_t, 3> dims{};  // samples along x, y, z; each at least 1
  SampleType type = SampleType::kF32;   // as stored in the source
  AffineMap index_to_world;             // of sample positions: a cell-centred source's half cell is already in origin
  std::uint64_t voxels() const { return dims[0] * dims[1] * dims[2]; }
  std::uint64_t layerBytes() const { return dims[0] * dims[1] * sampleBytes(type); }  // of one z
  std::uint64_t frameBytes() const { return dims[2] * layerBytes(); }
};

struct FrameFileHeader {
  std::string path;
  GridInfo grid;                // all products of sizes are proved to fit
  bool has_frame_axis = false;  // the file is made for many frames, if it holds one only
  std::uint64_t frames = 1;     // at most kMaxFrames
  std::vector<double> times;    // one per frame, or empty: the file tells none

  std::uint64_t frameBytes() const { return grid.frameBytes(); }
};

class FrameFile {
 public:
  virtual ~FrameFile() = default;
  virtual const FrameFileHeader& header() const = 0;
  // Reads layers [z_begin, z_end) of frame k: exactly that many samples, native byte order, in the file's own type.
  // Within one frame layers are asked for in growing order. Holds no more than a fixed buffer, unless the format says
  // otherwise. Throws Error{kBadInput} naming the data file and the byte: a file that has become short, a truncated or
  // broken compressed stream, a wrong checksum.
  virtual void readLayers(std::uint64_t frame, std::uint64_t z_begin, std::uint64_t z_end,
                          std::span<std::byte> samples) = 0;
  // Gives back descriptors and buffers; the next read opens again.
  virtual void close() = 0;
  // All layers of frame k, header().frameBytes() bytes.
  void readFrame(std::uint64_t frame, std::span<std::byte> samples) {
    readLayers(frame, 0, header().grid.dims[2], samples);
  }
};

// Where samples sit: on the nodes of the grid, or in the middle of its cells.
enum class Centering { kUntold, kNode, kCell };

// How the bytes of a raw file are to be understood.
struct RawLayout {
  std::array<std::uint64_t, 3> dims{};  // samples along x, y, z
  SampleType type = SampleType::kF32;
  bool big_endian = false;
  std::array<double, 3> spacing{1, 1, 1}, origin{0, 0, 0};  // world; origin is the corner of cells, or the first node
  std::uint64_t skip = 0;                                   // bytes in front of the samples
};

// What a file does not tell of itself.
struct FrameFileOptions {
  std::optional<RawLayout> raw;              // given: files are raw
  Centering centering = Centering::kUntold;  // where the format has centerings and the file tells none
  std::string array;  // which array of a VTK file, as selectVtkScalar() takes it; empty: the active or only scalar
};

// Opens a file by its suffix or, where that is of no known format, by its first bytes; with options.raw as a raw file.
// Throws Error naming file and place: the file cannot be opened, is of no known format, or its header is not proved by
// what is in it.
std::unique_ptr<FrameFile> openFrameFile(const std::string& path, const FrameFileOptions& options = {});

// "2 x 3 x 4", for messages.
std::string sizeText(const GridInfo& grid);

// The name of the format a file's suffix stands for ("NRRD"); empty for other suffixes. No file is opened.
std::string_view frameFormatOf(const std::string& path);
// All suffixes that stand for a format, for messages: ".nrrd, .nhdr, …".
std::string frameSuffixes();

}  // namespace tet4d::exchange
