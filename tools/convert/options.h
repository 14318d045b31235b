// What the parts of tet4d-convert share: the options as given and how a wrong use of them is told.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "libpreprocess/error.h"

namespace tet4d::convert {

struct Options {
  std::vector<std::string> inputs;
  // Slices.
  std::string at, times;
  bool normals = false;
  // Frames.
  std::string codec = "raw";
  bool allow_gaps = false;
  std::vector<double> frame_times;

  bool wantsSlices() const { return !at.empty() || !times.empty(); }
};

inline constexpr const char* kPossible =
    "possible are: .t4h to .vtu, .hyper; .t4h with --at to .ply, .vtp; .t4h with --times to a pattern such as %04d.ply "
    "or to .pvd; frames (.nrrd, .nhdr, .t4g, a directory, a pattern) to .t4g, .nrrd";

[[noreturn]] inline void failUsage(const std::string& what, const std::string& remedy = kPossible) {
  throw Error(FaultCode::kUsage, "", "", what, remedy);
}

inline std::string suffixOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

}  // namespace tet4d::convert
