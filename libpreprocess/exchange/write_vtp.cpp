#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/vtk_xml.h"
#include "libpreprocess/exchange/write_mesh.h"

namespace tet4d::exchange {

void writeVtp(const std::string& path, const WorldMesh& mesh, double time, bool as_double, bool force) {
  const std::uint64_t points = mesh.points.size(), triangles = mesh.triangles.size();
  const std::uint64_t point_bytes = points * 3 * (as_double ? sizeof(double) : sizeof(float));
  const std::uint64_t normal_bytes = mesh.normals.size() * sizeof(Vec3f);
  const std::uint64_t index_bytes = triangles * 3 * sizeof(std::int64_t),
                      offset_bytes = triangles * sizeof(std::int64_t);

  VtkHeader header("PolyData");
  header.timeValue(time);
  header.add("    <Piece NumberOfPoints=\"" + std::to_string(points) +
             "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
             std::to_string(triangles) + "\">\n");
  if (!mesh.normals.empty()) {
    header.add("      <PointData Normals=\"Normals\">\n");
    header.array("Float32", "Normals", 3, normal_bytes);
    header.add("      </PointData>\n");
  }
  header.add("      <Points>\n");
  header.array(as_double ? "Float64" : "Float32", "Points", 3, point_bytes);
  header.add("      </Points>\n      <Polys>\n");
  header.array("Int64", "connectivity", 1, index_bytes);
  header.array("Int64", "offsets", 1, offset_bytes);
  header.add("      </Polys>\n    </Piece>\n");

  outofcore::OutputFile file(path, force);
  file.write(header.finish());
  if (!mesh.normals.empty()) {
    beginVtkArray(file, normal_bytes);
    file.write(std::as_bytes(std::span(mesh.normals)));
  }
  beginVtkArray(file, point_bytes);
  for (const auto& point : mesh.points) {
    for (const double coordinate : point) {
      if (as_double) {
        file.writeValue(coordinate);
      } else {
        file.writeValue(static_cast<float>(coordinate));
      }
    }
  }
  beginVtkArray(file, index_bytes);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) file.writeValue(std::int64_t{corner});
  }
  beginVtkArray(file, offset_bytes);
  for (std::uint64_t i = 1; i <= triangles; ++i) file.writeValue(static_cast<std::int64_t>(3 * i));
  file.write(kVtkEnd);
  file.commit();
}

void writePvd(const std::string& path, const std::vector<std::pair<double, std::string>>& steps, bool force) {
  outofcore::OutputFile file(path, force);
  file.write(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  "
      "<Collection>\n");
  for (const auto& [time, name] : steps) {
    file.write("    <DataSet timestep=\"" + numberText(time) + "\" part=\"0\" file=\"" + xmlText(name) + "\"/>\n");
  }
  file.write("  </Collection>\n</VTKFile>\n");
  file.commit();
}

}  // namespace tet4d::exchange
