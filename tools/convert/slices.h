// Slices of a hypermesh as files for other programs: the part of tet4d-convert behind --at and --times.
#pragma once

#include "formats/hypermesh.h"
#include "tools/common/cli.h"
#include "tools/convert/options.h"

namespace tet4d::convert {

// Writes the slices that the options ask for, one after the other; memory of one slice and the pages alive then.
// Throws Error{kUsage} before anything is written where the options do not fit the mesh or the output's suffix.
void writeSlices(cli::Session& session, const hypermesh::File& mesh, const Options& options);

}  // namespace tet4d::convert
