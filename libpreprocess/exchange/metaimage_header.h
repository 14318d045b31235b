// What a MetaImage header (.mha, .mhd) means to a reader of frames: the grid, the times, and where the samples are.
// Format: MetaIO, itk.org/Wiki/ITK/MetaIO/Documentation; positions as ITK and ParaView read them.
//
// NDims 3 is one frame, 4 frames along the last axis. Offset is the position of the first sample, ElementSpacing the
// distance of samples, row i of TransformMatrix the direction of axis i. With NDims 4 the last entries are time.
#pragma once

#include <string>

#include "libpreprocess/exchange/frame_file.h"
#include "libpreprocess/exchange/sample_files.h"

namespace tet4d::exchange {

struct MetaImageHeader : FrameFileHeader {  // has_frame_axis: NDims 4
  SampleFiles data;
};

// Reads and proves a header: every number in range, all products without overflow, the data files present and long
// enough for their samples (compressed: not provably too short), the times growing. Reads no samples. Keys that say
// nothing of positions or bytes are passed over. Throws Error{kBadInput} naming file and line.
MetaImageHeader readMetaImageHeader(const std::string& path);

}  // namespace tet4d::exchange
