// tet4d-play --renderer tets: the paper's baseline, a hypermesh as it is, its tetrahedra sliced by the shader.
#pragma once

#include "tools/play/options.h"

namespace tet4d::play {

// Draws the one .t4h of `options` into pictures or a film, with its totals in the statistics: triangles_drawn,
// gpu_bytes. Throws Error (kUsage) for what it does not know: columns, parts, contact sheets. Returns the program's
// exit code.
int playBaseline(cli::Session& session, const Options& options);

}  // namespace tet4d::play
