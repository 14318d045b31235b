// Mesh sequences into one file: the part of tet4d-convert for surfaces with the same connectivity in every frame.
#pragma once

#include "tools/common/cli.h"
#include "tools/convert/options.h"

namespace tet4d::convert {

// Opens the inputs as surfaces and writes them as a .t4q. Memory of one frame and its file.
void convertSurfaces(cli::Session& session, const Options& options);

}  // namespace tet4d::convert
