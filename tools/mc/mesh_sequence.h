// Mesh sequences with the same connectivity → hypermesh: the part of tet4d-mc for what is no volume.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/common/cli.h"

namespace tet4d::mc {

struct MeshOptions {
  std::string tolerance;                // --linear-tolerance: a length, or with % a part of the diagonal; or empty
  std::optional<std::uint64_t> window;  // --linear-window
  bool given() const { return !tolerance.empty() || window; }
  void declare(cli::Command& command);
};

// Opens the inputs as surfaces, builds prisms and writes --output, or prints the plan of --dry-run. `times`: world
// times of the frames, or none.
int buildMeshSequence(cli::Session& session, const std::vector<std::string>& inputs, const std::vector<double>& times,
                      bool allow_gaps, bool compressed, const MeshOptions& options);

}  // namespace tet4d::mc
