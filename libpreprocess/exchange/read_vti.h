// VTK image data (.vti) as one frame, and .pvd series of them.
//
// Point data are node-centred; cell data become a grid of cell centres, one sample fewer along an axis. Several pieces
// that cover the whole extent without overlap are one grid. A TimeValue among the field data is the frame's time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "libpreprocess/exchange/frame_file.h"

namespace tet4d::exchange {

// Opens a .vti; `array` as in selectVtkScalar(). Throws as readVtkDocument() and openVtkArray() do, and
// Error{kBadInput} for pieces that overlap or leave gaps, a direction that is degenerate, sizes that do not fit. Of the
// file it keeps the header; the arrays of all pieces are open while it is read.
std::unique_ptr<FrameFile> openVti(const std::string& path, const std::string& array);

struct PvdStep {
  double time;
  std::string file;  // relative names are resolved beside the .pvd
};

// The steps of a .pvd series in time order. Throws Error{kBadInput} naming the line: no series, no steps, a time that
// is no number, several parts of one time.
std::vector<PvdStep> readPvd(const std::string& path);

}  // namespace tet4d::exchange
