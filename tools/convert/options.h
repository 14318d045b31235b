// What the parts of tet4d-convert share: the options as given and how a wrong use of them is told.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "tools/frames/frame_options.h"

namespace tet4d::convert {

struct Options {
  std::vector<std::string> inputs;
  // Slices.
  std::string at, times;
  bool normals = false;
  std::string normals_from = "slice", columns = "none";
  bool velocity = false;
  std::optional<std::uint64_t> draco_bits, part;
  // Meshes with a scalar as time.
  std::string scalar_as_time;
  std::uint64_t sweep_frames = 65;
  bool tets_only = false;
  // Frames.
  std::string codec = "raw";
  frames::FrameOptions frames;

  bool wantsSlices() const { return !at.empty() || !times.empty(); }
  // The first option given that only slices have; empty if there is none.
  std::string sliceOption() const {
    if (normals) return "--normals";
    if (normals_from != "slice") return "--normals-from";
    if (columns != "none") return "--columns";
    if (velocity) return "--velocity";
    if (draco_bits) return "--draco-bits";
    return part ? "--part" : "";
  }
};

inline constexpr const char* kPossible =
    "possible are: .t4h to .vtu, .hyper; .t4h with --at to .ply, .vtp, .off, .obj, .stl, .glb, .drc; .t4h with --times "
    "to a pattern such as %04d.ply or to .pvd; a mesh (.vtu, .mesh, .msh, .node) with --scalar-as-time to .t4h; frames "
    "(.nrrd, .mha, .vti, .pvd, raw, .t4g, a directory, a pattern, -) to .t4g, .nrrd; meshes with "
    "the same faces (.obj, .off, .ply, .stl) to .t4q";

[[noreturn]] inline void failUsage(const std::string& what, const std::string& remedy = kPossible) {
  throw Error(FaultCode::kUsage, "", "", what, remedy);
}

inline std::string suffixOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

}  // namespace tet4d::convert
