// tet4d-play --renderer tets: the paper's baseline, a hypermesh as it is, its tetrahedra sliced by the shader.
#pragma once

#include <memory>
#include <string>

#include "player/host/tet_film.h"
#include "tools/common/cli.h"

namespace tet4d::play {

// Draws `input` (a .t4h) at `times` (as --times has it; empty: every frame) into `sink`, with its totals in the
// statistics: triangles_drawn, gpu_bytes. `camera`: a camera file, or empty.
void playBaseline(cli::Session& session, const hypermesh::File& file, const std::vector<SliceTime>& times,
                  const std::string& camera, const scene::Format& format, host::FrameSink* sink);

}  // namespace tet4d::play
