// The names a run reads and writes, compared before any work: no output may replace an input or another output.
#pragma once

#include <string>
#include <vector>

#include "formats/core/result.h"

namespace tet4d::host {

struct NamedPath {
  std::string role;  // as a message names it: "--contact-sheet"
  std::string path;
};

// A Fault (kUsage) that names both roles if two names mean one file: the same file on disk, or the same place where
// none exists yet. Inputs may be alike. Empty paths, "-", pipes and devices are left out. O(n log n) look-ups.
Status checkNamesDiffer(const std::vector<NamedPath>& inputs, const std::vector<NamedPath>& outputs);

}  // namespace tet4d::host
