#include <utility>

#include "libpreprocess/exchange/mesh_pages.h"
#include "libpreprocess/exchange/vtk_xml.h"
#include "libpreprocess/exchange/write_mesh.h"

namespace tet4d::exchange {
namespace {

constexpr std::uint8_t kVtkTetra = 10;

void writePoint(outofcore::OutputFile& file, const std::array<double, 3>& world, bool as_double) {
  if (as_double) {
    file.writeValue(world);
    return;
  }
  file.writeValue(Vec3f{static_cast<float>(world[0]), static_cast<float>(world[1]), static_cast<float>(world[2])});
}

}  // namespace

void writeVtu(const std::string& path, const hypermesh::File& mesh, bool force) {
  const AffineMap& map = mesh.header().index_to_world;
  const std::uint64_t vertices = mesh.header().vertices, tets = mesh.header().tets;
  const bool as_double = needsDouble(map, mesh.header().domain), mirrored = isLeftHanded(map);
  const std::uint64_t point_bytes = vertices * 3 * (as_double ? sizeof(double) : sizeof(float));
  const std::uint64_t time_bytes = vertices * sizeof(double), index_bytes = tets * 4 * sizeof(std::uint64_t);

  VtkHeader header("UnstructuredGrid");
  header.add("    <Piece NumberOfPoints=\"" + std::to_string(vertices) + "\" NumberOfCells=\"" + std::to_string(tets) +
             "\">\n      <PointData Scalars=\"t\">\n");
  header.array("Float64", "t", 1, time_bytes);
  header.add("      </PointData>\n      <Points>\n");
  header.array(as_double ? "Float64" : "Float32", "Points", 3, point_bytes);
  header.add("      </Points>\n      <Cells>\n");
  header.array("UInt64", "connectivity", 1, index_bytes);
  header.array("UInt64", "offsets", 1, tets * sizeof(std::uint64_t));
  header.array("UInt8", "types", 1, tets);
  header.add("      </Cells>\n    </Piece>\n");

  outofcore::OutputFile file(path, force);
  file.write(header.finish());
  beginVtkArray(file, time_bytes);
  forEachVertex(mesh, [&](const Vec4f& vertex) { file.writeValue(timeOfFrame(mesh.times(), double{vertex.t})); });
  beginVtkArray(file, point_bytes);
  forEachVertex(mesh, [&](const Vec4f& vertex) {
    writePoint(file, toWorld(map, {double{vertex.x}, double{vertex.y}, double{vertex.z}}), as_double);
  });
  beginVtkArray(file, index_bytes);
  forEachPage(mesh, [&](const hypermesh::GatheredPage& page) {
    const auto numbers = globalNumbers(page.view);
    for (hypermesh::Tet tet : page.view.tets) {
      if (mirrored) std::swap(tet[2], tet[3]);
      for (const std::uint32_t corner : tet) file.writeValue(numbers[corner]);
    }
  });
  beginVtkArray(file, tets * sizeof(std::uint64_t));
  for (std::uint64_t i = 1; i <= tets; ++i) file.writeValue(4 * i);
  beginVtkArray(file, tets);
  for (std::uint64_t i = 0; i < tets; ++i) file.writeValue(kVtkTetra);
  file.write(kVtkEnd);
  file.commit();
}

}  // namespace tet4d::exchange
