// tet4d-mc on frames of a volume: marching hypercubes.
#pragma once

#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/frames/frame_options.h"
#include "tools/mc/extract_options.h"

namespace tet4d::mc {

// Opens the frames, extracts, writes the file and reports; with --dry-run prints the plan. Returns the exit code.
int extractVolume(cli::Session& session, const std::vector<std::string>& inputs,
                  const frames::FrameOptions& frame_options, const ExtractOptions& given);

}  // namespace tet4d::mc
