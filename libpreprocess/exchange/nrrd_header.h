// What a NRRD header means to a reader of frames: the grid, the times, and where the samples' bytes are.
//
// Dimension 3 is one frame, dimension 4 frames along the last axis; an axis of size 1 in front of them is a scalar.
// Positions: with space directions the space origin is the first sample; otherwise the axis min is, and a cell-centred
// axis puts the first sample half a cell behind it. Times: `time:=T` (3D), `times:=T T …` (4D), otherwise the last
// axis.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libpreprocess/exchange/frame_file.h"
#include "libpreprocess/exchange/nrrd_fields.h"

namespace tet4d::exchange {

enum class NrrdEncoding { kRaw, kGzip };

// Where the bytes of the samples are. All files together are the array, in order, with equal parts.
struct NrrdData {
  NrrdEncoding encoding = NrrdEncoding::kRaw;
  bool swap_bytes = false;       // stored in the other byte order than this machine's
  std::uint64_t files = 1;       // how many files the samples are divided on
  std::uint64_t file_bytes = 0;  // of samples in each, decoded
  bool attached = true;
  std::uint64_t attached_at = 0;   // offset of attached data
  std::uint64_t line_skip = 0;     // lines before the data, before any decoding
  std::int64_t byte_skip = 0;      // bytes before the data, after decoding; -1: the data are the end of the file (raw)
  std::vector<std::string> names;  // paths of single or listed files
  std::string pattern;             // or a name beside the header with one %d …
  std::int64_t pattern_min = 0, pattern_step = 1;

  // Path of file k.
  std::string fileName(const std::string& header_path, std::uint64_t k) const;
};

struct NrrdHeader : FrameFileHeader {  // has_frame_axis: dimension 4
  NrrdData data;
};

// Where the samples' bytes begin in a data file; for gzip, where the stream begins. Throws if lines to skip are
// missing.
std::uint64_t nrrdDataOffset(const InputFile& file, const NrrdData& data);

// Reads and proves a header: every number in range, all products without overflow, the data files present and long
// enough for their samples (for gzip: not provably too short). Reads no samples. Throws Error naming file and line.
NrrdHeader readNrrdHeader(const std::string& path);

}  // namespace tet4d::exchange
