#include "libpreprocess/exchange/write_mesh.h"

#include "libpreprocess/exchange/column_names.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {
namespace {

std::string plyHeader(const WorldMesh& mesh, const std::string& type) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.points.size()) + "\n";
  UniqueNames names;
  const auto floatProperty = [&](const std::string& name) { text += "property float " + names.unique(name) + "\n"; };
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) names.unique(name);  // theirs, whatever columns are called
  for (const char* name : {"x", "y", "z"}) text += "property " + type + " " + name + "\n";
  if (!mesh.normals.empty()) {
    for (const char* name : {"nx", "ny", "nz"}) text += std::string("property float ") + name + "\n";
  }
  for (const MeshColumn& column : mesh.columns) {
    const std::string name = identifier(column.name);
    for (unsigned c = 0; c < column.components; ++c) {
      floatProperty(column.components == 1 ? name : name + "_" + "xyzw"[c]);
    }
  }
  text += "element face " + std::to_string(mesh.triangles.size()) +
          "\nproperty list uchar int vertex_indices\nend_header\n";
  return text;
}

}  // namespace

void writePly(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  outofcore::OutputFile file(path, options.force);
  file.write(plyHeader(mesh, options.as_double ? "double" : "float"));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (const double coordinate : mesh.points[i]) {
      if (options.as_double) {
        file.writeValue(coordinate);
      } else {
        file.writeValue(static_cast<float>(coordinate));
      }
    }
    if (!mesh.normals.empty()) file.writeValue(mesh.normals[i]);
    for (const MeshColumn& column : mesh.columns) {
      file.write(std::as_bytes(std::span(column.values).subspan(i * column.components, column.components)));
    }
  }
  for (const auto& triangle : mesh.triangles) {
    file.writeValue(std::uint8_t{3});
    file.writeValue(triangle);
  }
  file.commit();
}

}  // namespace tet4d::exchange
