#include "libpreprocess/exchange/read_tet_mesh.h"

#include <cmath>
#include <filesystem>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/tet_mesh_formats.h"

namespace tet4d::exchange {
namespace {

struct Format {
  const char* suffix;
  TetMesh (*read)(const std::string& path, const TetMeshOptions& options);
};
constexpr std::array<Format, 5> kFormats{{
    {".vtu", readVtu},
    {".mesh", readMedit},
    {".msh", readGmsh},
    {".node", readTetgen},
    {".ele", readTetgen},
}};

}  // namespace

bool isTetMeshName(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  for (const Format& format : kFormats) {
    if (suffix == format.suffix) return true;
  }
  return false;
}

TetMesh readTetMesh(const std::string& path, const TetMeshOptions& options) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  for (const Format& format : kFormats) {
    if (suffix == format.suffix) return format.read(path, options);
  }
  throw Error(FaultCode::kUsage, path, "", "its suffix is of no known format of tetrahedra",
              "give a .vtu, .mesh, .msh, .node or .ele");
}

void checkPoint(const TetMesh& mesh, std::size_t i) {
  const auto& p = mesh.points[i];
  if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) return;
  throw Error(FaultCode::kBadInput, mesh.path, "point " + std::to_string(i), "has a coordinate that is not finite",
              "remove it, or write the file again");
}

bool isCoordinate(const std::string& name) { return name == "x" || name == "y" || name == "z"; }

void takeCoordinate(TetMesh& mesh, const std::string& name) {
  const std::size_t axis = name == "x" ? 0 : name == "y" ? 1 : 2;
  mesh.scalar.resize(mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i) mesh.scalar[i] = mesh.points[i][axis];
}

}  // namespace tet4d::exchange
