// What a NRRD header means to a reader of frames: the grid, the times, and where the samples' bytes are.
//
// Dimension 3 is one frame, dimension 4 frames along the last axis; an axis of size 1 in front of them is a scalar.
// Positions: with space directions the space origin is the first sample; otherwise the axis min is, and a cell-centred
// axis puts the first sample half a cell behind it (the caller's centering counts where the header tells none). Times:
// `time:=T` (3D), `times:=T T …` (4D), otherwise the last axis.
#pragma once

#include <string>

#include "libpreprocess/exchange/frame_file.h"
#include "libpreprocess/exchange/nrrd_fields.h"
#include "libpreprocess/exchange/sample_files.h"

namespace tet4d::exchange {

struct NrrdHeader : FrameFileHeader {  // has_frame_axis: dimension 4
  SampleFiles data;
};

// What the fields say, every number in range and all products without overflow; data files are not looked for, and
// times are left empty. Throws Error naming file and line.
NrrdHeader nrrdHeaderOf(const NrrdFields& fields, Centering centering);

// Reads and proves a header: as above, the data files present and long enough for their samples (for gzip: not
// provably too short), the times growing. Reads no samples.
NrrdHeader readNrrdHeader(const std::string& path, Centering centering);

}  // namespace tet4d::exchange
