// Every part of a hypermesh, simplified in turn; under a promise if one is asked for.
#pragma once

#include <optional>
#include <vector>

#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "tools/common/cli.h"
#include "tools/qslim/options.h"

namespace tet4d::qslim {

// Of one part.
struct SimplifiedPart {
  qslim4d::PackedMesh mesh;
  qslim4d::Stats stats;
  qslim4d::NonManifold non_manifold;
  std::uint64_t tets_in = 0;
  // Of --max-error: how often it was simplified, the estimate that kept the promise, and what was measured: a proven
  // bound if kept, else the least of what broke it.
  std::uint64_t tries = 1;
  bool is_kept = true;
  double estimate = 0, measured = 0;
};

// The parts in order, one for a file without parts. Ends early after a part whose promise could not be kept.
std::vector<SimplifiedPart> simplifyParts(cli::Session& session, const hypermesh::File& file, const Options& options,
                                          const std::vector<qslim4d::PlannedColumn>& columns);

// Bytes that it holds at most.
std::uint64_t boundMemory(const hypermesh::File& file, const Options& options,
                          const std::vector<qslim4d::ColumnWish>& wishes);

}  // namespace tet4d::qslim
