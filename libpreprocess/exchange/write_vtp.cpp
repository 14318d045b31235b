#include "libpreprocess/exchange/column_names.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/vtk_xml.h"
#include "libpreprocess/exchange/write_mesh.h"

namespace tet4d::exchange {

namespace {

// The arrays of the points: names safe and no two alike, sizes, and which of them VTK takes for normals and vectors.
class PointArrays {
 public:
  explicit PointArrays(const WorldMesh& mesh) : mesh_(mesh) {
    if (!mesh.normals.empty()) normals_ = names_.unique("Normals");
    for (const MeshColumn& column : mesh.columns) columns_.push_back(names_.unique(printableName(column.name)));
  }

  void declare(VtkHeader& header) const {
    if (mesh_.normals.empty() && mesh_.columns.empty()) return;
    std::string active = mesh_.normals.empty() ? "" : " Normals=\"" + normals_ + "\"";
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const MeshColumn& column = mesh_.columns[c];
      if (column.name == kVelocity && column.components == 3) active += " Vectors=\"" + xmlText(columns_[c]) + "\"";
    }
    header.add("      <PointData" + active + ">\n");
    if (!mesh_.normals.empty()) header.array("Float32", normals_, 3, mesh_.normals.size() * sizeof(Vec3f));
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      header.array("Float32", columns_[c], mesh_.columns[c].components, bytesOf(mesh_.columns[c]));
    }
    header.add("      </PointData>\n");
  }

  void write(outofcore::OutputFile& file) const {
    if (!mesh_.normals.empty()) {
      beginVtkArray(file, mesh_.normals.size() * sizeof(Vec3f));
      file.write(std::as_bytes(std::span(mesh_.normals)));
    }
    for (const MeshColumn& column : mesh_.columns) {
      beginVtkArray(file, bytesOf(column));
      file.write(std::as_bytes(std::span(column.values)));
    }
  }

 private:
  static std::uint64_t bytesOf(const MeshColumn& column) { return column.values.size() * sizeof(float); }

  const WorldMesh& mesh_;
  UniqueNames names_;
  std::string normals_;
  std::vector<std::string> columns_;
};

}  // namespace

void writeVtp(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  const bool as_double = options.as_double;
  const std::uint64_t points = mesh.points.size(), triangles = mesh.triangles.size();
  const std::uint64_t point_bytes = points * 3 * (as_double ? sizeof(double) : sizeof(float));
  const std::uint64_t index_bytes = triangles * 3 * sizeof(std::int64_t),
                      offset_bytes = triangles * sizeof(std::int64_t);

  const PointArrays arrays(mesh);
  VtkHeader header("PolyData");
  header.timeValue(options.time);
  header.add("    <Piece NumberOfPoints=\"" + std::to_string(points) +
             "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
             std::to_string(triangles) + "\">\n");
  arrays.declare(header);
  header.add("      <Points>\n");
  header.array(as_double ? "Float64" : "Float32", "Points", 3, point_bytes);
  header.add("      </Points>\n      <Polys>\n");
  header.array("Int64", "connectivity", 1, index_bytes);
  header.array("Int64", "offsets", 1, offset_bytes);
  header.add("      </Polys>\n    </Piece>\n");

  outofcore::OutputFile file(path, options.force);
  file.write(header.finish());
  arrays.write(file);
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
