// Single comparisons: two surfaces, two pictures.
#pragma once

#include <string>

#include "tools/common/cli.h"

namespace tet4d::report {

struct CompareOptions {
  std::string a, b;
  double tolerance = 0;  // world units; 0: 1e-4 of the diagonal
  std::uint64_t samples = 200'000;
  bool json = false;
};

// Prints distances of two triangle meshes (.obj, .off, .ply, .stl; of a sequence its first frame), and their areas.
int compareSurfaces(cli::Session& session, const CompareOptions& options);
// Prints errors of two PNG pictures of one size.
int comparePngs(cli::Session& session, const CompareOptions& options);

}  // namespace tet4d::report
