#include "libpreprocess/exchange/mesh_pages.h"

#include "libpreprocess/error.h"

namespace tet4d::exchange {

void forEachPage(const hypermesh::File& mesh, const std::function<void(const hypermesh::GatheredPage&)>& visit) {
  std::uint64_t vertices = 0, tets = 0;
  const auto fail = [&](std::size_t page, const std::string& what) {
    throw Error(FaultCode::kBadInput, mesh.reader().path(), "page " + std::to_string(page), what,
                "make the file again");
  };
  for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
    const hypermesh::GatheredPage page = unwrap(mesh.gather(k));
    if (page.view.header->first_vertex != vertices) {
      fail(k, "its first vertex is " + std::to_string(page.view.header->first_vertex) + ", expected " +
                  std::to_string(vertices));
    }
    vertices += page.view.vertices.size();
    tets += page.view.tets.size();
    visit(page);
  }
  if (vertices != mesh.header().vertices || tets != mesh.header().tets) {
    fail(mesh.geometryPages(), "the pages hold " + std::to_string(vertices) + " vertices and " + std::to_string(tets) +
                                   " tetrahedra, the header tells of " + std::to_string(mesh.header().vertices) +
                                   " and " + std::to_string(mesh.header().tets));
  }
}

void forEachVertex(const hypermesh::File& mesh, const std::function<void(const Vec4f&)>& visit) {
  forEachPage(mesh, [&](const hypermesh::GatheredPage& page) {
    for (const Vec4f& vertex : page.view.vertices) visit(vertex);
  });
}

std::vector<std::uint64_t> globalNumbers(const hypermesh::PageView& page) {
  std::vector<std::uint64_t> numbers;
  numbers.reserve(static_cast<std::size_t>(page.header->owned + page.header->foreign));
  for (std::uint64_t i = 0; i < page.header->owned; ++i) numbers.push_back(page.header->first_vertex + i);
  for (const hypermesh::Run& run : page.runs) {
    for (std::uint64_t i = 0; i < run.count; ++i) numbers.push_back(run.first + i);
  }
  return numbers;
}

}  // namespace tet4d::exchange
