#include "libpreprocess/qslim4d/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/foreign_runs.h"
#include "libpreprocess/exchange/mesh_pages.h"

namespace tet4d::qslim4d {
namespace {

constexpr std::uint64_t kMostTets = std::uint64_t{1} << 30;  // corners have u32 numbers

void checkSize(const hypermesh::File& file) {
  const hypermesh::MeshHeader& header = file.header();
  const auto refuse = [&](const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kBadInput, file.reader().path(), "", what, remedy);
  };
  refuseParts(file);
  if (header.vertices >= kNone || header.tets >= kMostTets)
    refuse("has " + std::to_string(header.vertices) + " vertices and " + std::to_string(header.tets) +
               " tetrahedra, too many to simplify in core (2^32 - 2 and 2^30 - 1)",
           "simplify it in cells, by the order passes or multichoice");
}

// The mesh without what is dead: vertices by time, tetrahedra by their first vertex.
struct Packed {
  std::vector<Vec4f> vertices;
  std::vector<hypermesh::Tet> tets;
  std::vector<std::uint64_t> first_tet;  // by vertex: the first tetrahedron whose smallest vertex is it or a later one
};

Packed pack(const SlimMesh& mesh) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.head[v] != kNone) order.push_back(v);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return mesh.positions[a].t < mesh.positions[b].t; });
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  Packed packed;
  for (const std::uint32_t v : order) {
    number[v] = static_cast<std::uint32_t>(packed.vertices.size());
    packed.vertices.push_back(mesh.positions[v]);
  }
  packed.tets.reserve(mesh.live_tets);
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    if (!mesh.isLive(t)) continue;
    hypermesh::Tet tet = mesh.tets[t];
    for (std::uint32_t& v : tet) v = number[v];
    packed.tets.push_back(tet);
  }
  const auto first = [](const hypermesh::Tet& tet) { return std::min({tet[0], tet[1], tet[2], tet[3]}); };
  std::stable_sort(packed.tets.begin(), packed.tets.end(),
                   [&](const hypermesh::Tet& a, const hypermesh::Tet& b) { return first(a) < first(b); });
  packed.first_tet.assign(packed.vertices.size() + 1, packed.tets.size());
  for (std::size_t t = packed.tets.size(); t-- > 0;) packed.first_tet[first(packed.tets[t])] = t;
  for (std::size_t v = packed.vertices.size(); v-- > 0;)
    packed.first_tet[v] = std::min(packed.first_tet[v], packed.first_tet[v + 1]);
  return packed;
}

// The end of the page that begins with vertex `begin`: whole frames, enough of them.
std::size_t pageEnd(const Packed& packed, std::size_t begin) {
  std::size_t end = begin;
  while (end < packed.vertices.size()) {
    const float frame = std::floor(packed.vertices[end].t);
    while (end < packed.vertices.size() && std::floor(packed.vertices[end].t) == frame) ++end;
    if (packed.first_tet[end] - packed.first_tet[begin] >= kLeastPageTets) break;
  }
  // What follows without a tetrahedron of its own belongs here too.
  return packed.first_tet[end] == packed.tets.size() ? packed.vertices.size() : end;
}

}  // namespace

void refuseParts(const hypermesh::File& file) {
  if (const std::uint64_t parts = file.header().parts; parts > 1)
    throw Error(FaultCode::kBadInput, file.reader().path(), "",
                "has " + std::to_string(parts) + " parts, but one part is simplified at a time",
                "extract one isovalue a file");
}

std::uint64_t simplifyBytes(std::uint64_t vertices, std::uint64_t tets) {
  // Edges: about 7 a vertex and 12 bytes each, in a vector that doubles; what a round holds beside them.
  constexpr std::uint64_t kEdgeBytes = 7 * 12 * 2, kRoundBytes = 32;
  return slimMeshBytes(vertices, tets) + vertices * (kEdgeBytes + kRoundBytes);
}

std::uint64_t boundMemory(const hypermesh::File& file) {
  const hypermesh::MeshHeader& header = file.header();
  std::uint64_t page = 0;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) page = std::max(page, file.gatherBytes(k));
  return simplifyBytes(header.vertices, header.tets) + page;
}

SlimMesh readMesh(const hypermesh::File& file, Metric metric, outofcore::Progress& progress) {
  checkSize(file);
  progress.phase("read", file.geometryPages());
  std::vector<Vec4f> positions;
  std::vector<hypermesh::Tet> tets;
  positions.reserve(file.header().vertices);
  tets.reserve(file.header().tets);
  std::size_t pages = 0;
  exchange::forEachPage(file, [&](const hypermesh::GatheredPage& page) {
    positions.insert(positions.end(), page.view.vertices.begin(), page.view.vertices.end());
    const std::vector<std::uint64_t> numbers = exchange::globalNumbers(page.view);
    for (const hypermesh::Tet& tet : page.view.tets) {
      tets.push_back({static_cast<std::uint32_t>(numbers[tet[0]]), static_cast<std::uint32_t>(numbers[tet[1]]),
                      static_cast<std::uint32_t>(numbers[tet[2]]), static_cast<std::uint32_t>(numbers[tet[3]])});
    }
    progress.step(++pages);
  });
  try {
    return makeSlimMesh(std::move(positions), std::move(tets), file.header().domain, file.header().index_to_world,
                        metric);
  } catch (const Error& error) {
    Fault fault = error.fault();
    if (fault.file.empty()) fault.file = file.reader().path();
    throw Error(fault);
  }
}

void writeMesh(const SlimMesh& mesh, double error_world, hypermesh::Writer& writer, outofcore::Progress& progress) {
  Packed packed = pack(mesh);
  progress.phase("write", packed.vertices.size());
  for (std::size_t begin = 0, end = 0; begin < packed.vertices.size(); begin = end) {
    end = pageEnd(packed, begin);
    const auto first = packed.tets.begin() + static_cast<std::ptrdiff_t>(packed.first_tet[begin]);
    std::vector<hypermesh::Tet> tets(first, packed.tets.begin() + static_cast<std::ptrdiff_t>(packed.first_tet[end]));
    Bounds4f bounds;
    std::uint64_t last = end;
    for (hypermesh::Tet& tet : tets) {
      for (std::uint32_t& v : tet) {
        bounds.add(packed.vertices[v]);
        last = std::max<std::uint64_t>(last, std::uint64_t{v} + 1);
        v -= static_cast<std::uint32_t>(begin);
      }
    }
    const std::vector<hypermesh::Run> runs =
        exchange::nameForeign(tets, end - begin, last - begin, writer.nextVertex());
    writer.setPageErrors(static_cast<float>(error_world), -1);
    const std::span<const Vec4f> vertices(packed.vertices.data() + begin, end - begin);
    unwrap(writer.addPage(vertices, runs, tets, bounds));
    progress.step(end);
  }
}

}  // namespace tet4d::qslim4d
