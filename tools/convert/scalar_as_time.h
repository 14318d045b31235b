// A tetrahedral mesh with a scalar as a hypermesh, the scalar as time: the part of tet4d-convert behind
// --scalar-as-time.
#pragma once

#include "tools/common/cli.h"
#include "tools/convert/options.h"

namespace tet4d::convert {

// Reads the one input as a mesh and writes a .t4h. Memory of the mesh and its order, and one page.
void convertScalarAsTime(cli::Session& session, const Options& options);

}  // namespace tet4d::convert
