// The formats of slices by suffix.
#include <algorithm>
#include <array>
#include <filesystem>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/write_mesh.h"

namespace tet4d::exchange {
namespace {

using WriteMesh = void (*)(const std::string&, const WorldMesh&, const MeshFileOptions&);

// Parallel to one another, but for .drc, which stands last and measures its own loss.
constexpr std::array kFormats{
    MeshFormat{".ply", true, true, true},    MeshFormat{".vtp", true, true, true},
    MeshFormat{".off", true, false, true},   MeshFormat{".obj", true, false, true},
    MeshFormat{".stl", false, false, false}, MeshFormat{".glb", true, true, false},
    MeshFormat{".drc", true, true, false},
};
constexpr std::array<WriteMesh, kFormats.size() - 1> kWriters{writePly, writeVtp, writeOff,
                                                              writeObj, writeStl, writeGlb};

}  // namespace

std::span<const MeshFormat> meshFormats() { return kFormats; }

const MeshFormat* meshFormatOf(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(), [&](const auto& f) { return f.suffix == suffix; });
  return found == kFormats.end() ? nullptr : found;
}

WriteLoss writeSlice(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  const MeshFormat* format = meshFormatOf(path);
  if (format == nullptr) {
    throw Error(FaultCode::kUsage, path, "", "slices cannot be written in this format", "see meshFormats()");
  }
  if (format->suffix == ".drc") return writeDraco(path, mesh, options);
  kWriters[static_cast<std::size_t>(format - kFormats.data())](path, mesh, options);
  if (options.as_double && format->doubles) return {};
  const bool moved = options.as_double && format->suffix == ".glb";
  WriteLoss loss;
  loss.position_world = floatError(mesh, moved ? options.origin : std::array<double, 3>{0, 0, 0});
  return loss;
}

}  // namespace tet4d::exchange
