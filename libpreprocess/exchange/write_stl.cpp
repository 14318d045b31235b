#include <cmath>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {
namespace {

// From the points in double: a far origin costs it nothing.
Vec3f facetNormal(const std::array<double, 3>& p, const std::array<double, 3>& q, const std::array<double, 3>& r) {
  const std::array<double, 3> u{q[0] - p[0], q[1] - p[1], q[2] - p[2]}, w{r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  const std::array<double, 3> n{u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length)};
}

}  // namespace

void writeStl(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  if (mesh.triangles.size() > 0xffffffffull) {
    throw Error(FaultCode::kBadInput, path, "", std::to_string(mesh.triangles.size()) + " triangles are too many",
                "STL counts in 32 bits: write .ply");
  }
  outofcore::OutputFile file(path, options.force);
  // Not beginning with "solid", by which readers know the text form.
  std::string head = "tet4d, binary STL, one slice";
  head.resize(80, ' ');
  file.write(head);
  file.writeValue(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& [a, b, c] : mesh.triangles) {
    file.writeValue(facetNormal(mesh.points[a], mesh.points[b], mesh.points[c]));
    for (const std::uint32_t corner : {a, b, c}) {
      for (const double x : mesh.points[corner]) file.writeValue(static_cast<float>(x));
    }
    file.writeValue(std::uint16_t{0});
  }
  file.commit();
}

}  // namespace tet4d::exchange
