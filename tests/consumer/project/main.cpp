// An outside program: writes a hypermesh of one tetrahedron, reads it back, slices it, and builds its dynamic
// triangles.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "formats/core/slicer.h"
#include "formats/hypermesh.h"
#include "libpreprocess/dyntri/dynamic_triangles_builder.h"

namespace {

int fail(const tet4d::Fault& fault) {
  std::fprintf(stderr, "%s: %s: %s\n", fault.file.c_str(), fault.place.c_str(), fault.what.c_str());
  return 1;
}

tet4d::Status writeOne(const std::string& path) {
  const std::vector<tet4d::Vec4f> vertices{{0, 0, 0, 0}, {2, 0, 0, 1}, {0, 2, 0, 1}, {0, 0, 2, 1}};
  const std::vector<tet4d::hypermesh::Tet> tets{{0, 1, 2, 3}};
  const std::vector<double> times{0, 1};
  tet4d::hypermesh::MeshHeader header{};
  header.domain = {{0, 0, 0, 0}, {2, 2, 2, 1}};
  header.isovalue = std::nan("");
  auto writer = tet4d::hypermesh::Writer::create(path, header, times, {}, tet4d::paged::Codec::kRaw, true);
  if (!writer.ok()) return writer.fault();
  if (auto added = writer.value().addPage(vertices, {}, tets, header.domain); !added.ok()) return added;
  return writer.value().close("{}");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  if (auto written = writeOne(argv[1]); !written.ok()) return fail(written.fault());
  auto file = tet4d::hypermesh::File::open(argv[1]);
  if (!file.ok()) return fail(file.fault());
  if (auto proved = file.value().verify(); !proved.ok()) return fail(proved.fault());
  auto page = file.value().gather(0);
  if (!page.ok()) return fail(page.fault());

  // Halfway the cone from a point to a triangle of side 2 * sqrt(2) is a triangle of half its side.
  tet4d::SliceMesh slice;
  tet4d::sliceTets(page.value().view.tets, page.value().positions, {}, 0.5f, 1.0f, slice);
  if (slice.triangles.size() != 1 || slice.positions.size() != 3) return 1;
  for (int k = 0; k < 3; ++k) {
    const auto& p = slice.positions[static_cast<std::size_t>(k)];
    const auto& q = slice.positions[static_cast<std::size_t>((k + 1) % 3)];
    const double side = std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
    if (std::abs(side - std::numbers::sqrt2) > 1e-6) return 1;
  }

  // Three vertices share the last time: of the four triangles only the first lives.
  const auto built = tet4d::dyntri::buildPage(page.value().view.tets, page.value().positions);
  if (built.triangles.size() != 1 || built.empty != 3) return 1;
  std::puts("consumer: one tetrahedron written, proved, sliced and built");
  return 0;
}
