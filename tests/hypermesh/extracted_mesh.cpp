#include "tests/hypermesh/extracted_mesh.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"

namespace tet4d::hypermesh::testing {

std::string temporaryPath(const std::string& name) {
  struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("tet4d_hypermesh_test_" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
  };
  static const Folder folder;
  return (folder.path / name).string();
}

ExtractedMesh extractTo(const std::string& path, exchange::FrameSource& source, const Options& options,
                        std::size_t threads) {
  ExtractedMesh mesh;
  {
    Writer writer = createWriter(path, source, options, true);
    outofcore::ThreadExecutor executor(threads);
    outofcore::MemoryBudget memory;
    outofcore::Progress progress;
    mesh.stats = buildHypermesh(source, writer, options, executor, memory, progress);
    unwrap(writer.close("{}"));
  }
  const File file = unwrap(File::open(path));
  unwrap(file.verify());
  mesh.header = file.header();
  mesh.times.assign(file.times().begin(), file.times().end());
  mesh.columns.resize(file.columns().size());
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const GatheredPage page = unwrap(file.gather(k));
    mesh.vertices.insert(mesh.vertices.end(), page.view.vertices.begin(), page.view.vertices.end());
    for (const Tet& tet : page.view.tets) {
      Tet global{};
      for (std::size_t i = 0; i < 4; ++i) global[i] = static_cast<std::uint32_t>(page.view.globalOf(tet[i]));
      mesh.tets.push_back(global);
    }
    mesh.pages.push_back({page.view.vertices.size(), page.view.tets.size()});
    mesh.page_parts.push_back(page.view.header->part);
    for (std::size_t c = 0; c < mesh.columns.size(); ++c) {
      const paged::PageBytes bytes = unwrap(file.loadColumn(c, k));
      const auto* values = reinterpret_cast<const float*>(bytes.bytes().data());
      mesh.columns[c].insert(mesh.columns[c].end(), values,
                             values + page.view.vertices.size() * file.columns()[c].components);
    }
  }
  std::ifstream in(path, std::ios::binary);
  mesh.bytes.assign(std::istreambuf_iterator<char>(in), {});
  return mesh;
}

ExtractedMesh extract(exchange::FrameSource& source, const Options& options, std::size_t threads) {
  const std::string path = temporaryPath("extracted.t4h");
  ExtractedMesh mesh = extractTo(path, source, options, threads);
  std::filesystem::remove(path);
  return mesh;
}

std::array<double, 4> normalOf(const ExtractedMesh& mesh, const Tet& tet) {
  std::array<std::array<double, 4>, 3> e{};
  const Vec4f& a = mesh.vertices[tet[0]];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec4f& b = mesh.vertices[tet[k + 1]];
    e[k] = {double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z, double{b.t} - a.t};
  }
  const auto minor = [&](std::size_t i, std::size_t j, std::size_t k) {
    return e[0][i] * (e[1][j] * e[2][k] - e[1][k] * e[2][j]) - e[0][j] * (e[1][i] * e[2][k] - e[1][k] * e[2][i]) +
           e[0][k] * (e[1][i] * e[2][j] - e[1][j] * e[2][i]);
  };
  return {minor(1, 2, 3), -minor(0, 2, 3), minor(0, 1, 3), -minor(0, 1, 2)};
}

double threeVolume(const ExtractedMesh& mesh) {
  double sum = 0;
  for (const Tet& tet : mesh.tets) {
    const auto n = normalOf(mesh, tet);
    sum += std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + n[3] * n[3]) / 6;
  }
  return sum;
}

double enclosedFourVolume(const ExtractedMesh& mesh) {
  double sum = 0;
  for (const Tet& tet : mesh.tets) {
    double x = 0;
    for (const std::uint32_t v : tet) x += mesh.vertices[v].x / 4.0;
    sum += x * normalOf(mesh, tet)[0] / 6;
  }
  return sum;
}

std::string manifoldFaults(exchange::FrameSource& source, const Options& options) {
  const std::string path = temporaryPath("manifold.t4h");
  extractTo(path, source, options);
  const File file = unwrap(File::open(path));
  outofcore::Progress progress;
  const topology::HypermeshCheck faces = topology::checkHypermesh(file, progress);
  outofcore::MemoryBudget memory;
  const topology::LinkCheck links = topology::checkLinks(file, memory, progress);
  // By the counts: a sheet of tetrahedra at one time is what data give that change everywhere alike.
  std::string faults;
  const auto none = [&](std::uint64_t count, const std::string& what) {
    if (count != 0) faults += std::to_string(count) + " " + what + "\n";
  };
  none(faces.faces_over_two, "faces in more than two tetrahedra");
  none(faces.misoriented_faces, "faces of opposite orientation");
  none((file.header().flags & kInnerBoundary) != 0 ? 0 : faces.inner_boundary_faces, "boundary faces on no wall");
  none(faces.unused_vertices, "vertices in no tetrahedron");
  for (const std::string& fault : links.faults) faults += fault + "\n";
  return faults;
}

}  // namespace tet4d::hypermesh::testing
