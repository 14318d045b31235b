// Sequences of frames into other formats: the part of tet4d-convert for everything that is no hypermesh.
#pragma once

#include "tools/common/cli.h"
#include "tools/convert/options.h"

namespace tet4d::convert {

// Opens the inputs as frames and writes them as one file, by the output's suffix. Memory of one frame.
void convertFrames(cli::Session& session, const Options& options);

}  // namespace tet4d::convert
