#include <limits>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {

void writeHyper(const std::string& path, const hypermesh::File& mesh, bool force) {
  if (mesh.header().vertices > std::uint64_t{std::numeric_limits<std::int32_t>::max()} + 1) {
    throw Error(
        FaultCode::kBadInput, mesh.reader().path(), "",
        std::to_string(mesh.header().vertices) + " vertices cannot be numbered in int32, the most is 2147483648",
        "write .vtu, which has 64-bit numbers");
  }
  outofcore::OutputFile points(path + ".pts4.f32", force), tets(path + ".tet.i32", force);
  forEachPage(mesh, [&](const hypermesh::GatheredPage& page) {
    points.write(std::as_bytes(page.view.vertices));
    const auto numbers = globalNumbers(page.view);
    for (const hypermesh::Tet& tet : page.view.tets) {
      for (const std::uint32_t corner : tet) tets.writeValue(static_cast<std::int32_t>(numbers[corner]));
    }
  });
  points.commit();
  tets.commit();
}

}  // namespace tet4d::exchange
