// OFF and OBJ: meshes as text.
#include <string>

#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {
namespace {

std::string pointText(const std::array<double, 3>& point, bool as_double) {
  std::string text;
  for (const double x : point) {
    if (!text.empty()) text += ' ';
    text += as_double ? numberText(x) : numberText(static_cast<float>(x));
  }
  return text;
}

std::string normalText(const Vec3f& n) { return numberText(n.x) + ' ' + numberText(n.y) + ' ' + numberText(n.z); }

}  // namespace

void writeOff(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  outofcore::OutputFile file(path, options.force);
  file.write(mesh.normals.empty() ? "OFF\n" : "NOFF\n");
  file.write(std::to_string(mesh.points.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n");
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    std::string line = pointText(mesh.points[i], options.as_double);
    if (!mesh.normals.empty()) line += ' ' + normalText(mesh.normals[i]);
    file.write(line + '\n');
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    file.write("3 " + std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(c) + '\n');
  }
  file.commit();
}

void writeObj(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  outofcore::OutputFile file(path, options.force);
  for (const auto& point : mesh.points) file.write("v " + pointText(point, options.as_double) + '\n');
  for (const Vec3f& normal : mesh.normals) file.write("vn " + normalText(normal) + '\n');
  for (const auto& triangle : mesh.triangles) {
    std::string line = "f";
    for (const std::uint32_t corner : triangle) {
      const std::string number = std::to_string(std::uint64_t{corner} + 1);  // they count from 1
      line += ' ' + number;
      if (!mesh.normals.empty()) line += "//" + number;
    }
    file.write(line + '\n');
  }
  file.commit();
}

}  // namespace tet4d::exchange
