#include "libpreprocess/qslim4d/packed_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/foreign_runs.h"

namespace tet4d::qslim4d {
namespace {

// Vertices begin .. end - 1 of a part.
struct Page {
  std::size_t part = 0, begin = 0, end = 0;
  std::uint64_t first = 0;  // number of its first vertex in the file
  Bounds4f bounds;
};

// The end of the page that begins with vertex `begin`: whole frames, enough of them and not too many.
std::size_t pageEnd(const PackedMesh& packed, std::size_t begin) {
  const auto tetsUntil = [&](std::size_t end) { return packed.first_tet[end] - packed.first_tet[begin]; };
  const std::size_t last = std::min(packed.vertices.size(), begin + kMostPageItems);
  std::size_t end = begin;
  while (end < last) {
    const float frame = std::floor(packed.vertices[end].t);
    for (; end < last && std::floor(packed.vertices[end].t) == frame; ++end)
      if (end > begin && tetsUntil(end + 1) > kMostPageItems) return end;
    if (tetsUntil(end) >= kLeastPageTets) break;
  }
  // What follows without a tetrahedron of its own belongs here too.
  return packed.first_tet[end] == packed.tets.size() ? last : end;
}

std::span<const hypermesh::Tet> tetsOf(const PackedMesh& packed, const Page& page) {
  return std::span(packed.tets)
      .subspan(packed.first_tet[page.begin], packed.first_tet[page.end] - packed.first_tet[page.begin]);
}

std::vector<Page> planPages(std::span<const PackedMesh> parts) {
  std::vector<Page> pages;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const PackedMesh& packed = parts[part];
    for (std::size_t begin = 0; begin < packed.vertices.size();) {
      Page page{part, begin, pageEnd(packed, begin), 0, {}};
      const auto tets = tetsOf(packed, page);
      for (const hypermesh::Tet& tet : tets)
        for (const std::uint32_t v : tet) page.bounds.add(packed.vertices[v]);
      for (std::size_t v = page.begin; v < page.end && tets.empty(); ++v) page.bounds.add(packed.vertices[v]);
      begin = page.end;
      pages.push_back(page);
    }
  }
  std::stable_sort(pages.begin(), pages.end(),
                   [](const Page& a, const Page& b) { return a.bounds.min.t < b.bounds.min.t; });
  std::uint64_t first = 0;
  for (Page& page : pages) page.first = std::exchange(first, first + page.end - page.begin);
  return pages;
}

// Numbers in the file of a part's vertices, by the pages of the part so far planned, ascending.
std::vector<std::uint64_t> numbersOf(std::span<const Page> pages, std::size_t part, std::size_t vertices) {
  std::vector<std::uint64_t> numbers(vertices);
  for (const Page& page : pages) {
    if (page.part != part) continue;
    for (std::size_t v = page.begin; v < page.end; ++v) numbers[v] = page.first + (v - page.begin);
  }
  return numbers;
}

// Vertices and their columns by time, those of one time as they were. number: not kNone for what is used; the new
// numbers then.
void packVertices(SlimMesh& mesh, std::vector<std::uint32_t>& number, PackedMesh& packed) {
  std::vector<std::uint32_t> order;
  order.reserve(number.size() - static_cast<std::size_t>(std::count(number.begin(), number.end(), kNone)));
  for (std::uint32_t v = 0; v < number.size(); ++v)
    if (number[v] != kNone) order.push_back(v);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mesh.positions[a].t != mesh.positions[b].t ? mesh.positions[a].t < mesh.positions[b].t : a < b;
  });
  packed.vertices.reserve(order.size());
  for (const std::uint32_t v : order) {
    number[v] = static_cast<std::uint32_t>(packed.vertices.size());
    packed.vertices.push_back(mesh.positions[v]);
  }
  release(mesh.positions);
  for (SlimColumn& column : mesh.columns.list) {
    std::vector<float>& values = packed.columns.emplace_back();
    values.reserve(order.size() * column.components);
    for (const std::uint32_t v : order) {
      const auto first = column.values.begin() + static_cast<std::ptrdiff_t>(std::size_t{v} * column.components);
      values.insert(values.end(), first, first + column.components);
    }
    release(column.values);
  }
}

// Tetrahedra by their least vertex, those of one vertex as they were.
void packTets(const std::vector<hypermesh::Tet>& tets, PackedMesh& packed) {
  const auto least = [](const hypermesh::Tet& tet) { return std::min({tet[0], tet[1], tet[2], tet[3]}); };
  std::vector<std::uint64_t>& first = packed.first_tet;
  first.assign(packed.vertices.size() + 1, 0);
  for (const hypermesh::Tet& tet : tets) ++first[least(tet)];
  std::exclusive_scan(first.begin(), first.end(), first.begin(), std::uint64_t{0});
  packed.tets.resize(tets.size());
  for (const hypermesh::Tet& tet : tets) packed.tets[first[least(tet)]++] = tet;
  // Each has come to where the next one's begin.
  std::shift_right(first.begin(), first.end(), 1);
  first.front() = 0;
}

}  // namespace

PackedMesh pack(SlimMesh mesh) {
  // What only collapses read makes room for the result.
  release(mesh.quadrics), release(mesh.corners), release(mesh.stars), release(mesh.walls), release(mesh.is_boundary);
  release(mesh.columns.squares), release(mesh.columns.sums);
  std::erase_if(mesh.tets, [](const hypermesh::Tet& tet) { return tet[0] == kNone; });
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  for (const hypermesh::Tet& tet : mesh.tets)
    for (const std::uint32_t v : tet) number[v] = 0;
  PackedMesh packed;
  packVertices(mesh, number, packed);
  for (hypermesh::Tet& tet : mesh.tets)
    for (std::uint32_t& v : tet) v = number[v];
  release(number);
  packTets(mesh.tets, packed);
  return packed;
}

std::uint64_t packBytes(std::uint64_t vertices, std::uint64_t tets) {
  // Vertices with their first tetrahedra, and tetrahedra; beside them the mesh's and the numbers, or the numbers in the
  // file and a page, which may be the whole, twice: named anew, and as it is written.
  const std::uint64_t packed = vertices * (sizeof(Vec4f) + sizeof(std::uint64_t)) + tets * sizeof(hypermesh::Tet);
  return packed + std::max(vertices * (sizeof(Vec4f) + 2 * sizeof(std::uint32_t)) + tets * sizeof(hypermesh::Tet),
                           vertices * (sizeof(Vec4f) + sizeof(std::uint64_t)) + 2 * tets * sizeof(hypermesh::Tet));
}

void writeMeshes(std::span<const PackedMesh> parts, hypermesh::Writer& writer, outofcore::Progress& progress) {
  const std::vector<Page> pages = planPages(parts);
  std::vector<std::vector<std::uint64_t>> numbers;
  for (std::size_t part = 0; part < parts.size(); ++part)
    numbers.push_back(numbersOf(pages, part, parts[part].vertices.size()));
  progress.phase("write", pages.size());
  std::uint64_t written = 0;
  for (const Page& page : pages) {
    const PackedMesh& packed = parts[page.part];
    const std::size_t owned = page.end - page.begin;
    const auto own_tets = tetsOf(packed, page);
    std::vector<hypermesh::Tet> tets(own_tets.begin(), own_tets.end());
    std::uint64_t last = owned;
    for (hypermesh::Tet& tet : tets) {
      for (std::uint32_t& v : tet) {
        const std::uint64_t local = numbers[page.part][v] - page.first;
        last = std::max(last, local + 1);
        v = static_cast<std::uint32_t>(local);
      }
    }
    const std::vector<hypermesh::Run> runs = exchange::nameForeign(tets, owned, last, page.first);
    std::vector<std::span<const float>> columns;
    for (const std::vector<float>& values : packed.columns) {
      const std::size_t components = values.size() / packed.vertices.size();
      columns.push_back(std::span(values).subspan(page.begin * components, owned * components));
    }
    writer.setPageErrors(packed.error_estimated, packed.error_measured);
    unwrap(writer.addPage(std::span(packed.vertices).subspan(page.begin, owned), runs, tets, page.bounds, columns,
                          page.part));
    progress.step(++written);
  }
}

void writeMesh(const SlimMesh& mesh, double error_world, hypermesh::Writer& writer, outofcore::Progress& progress) {
  PackedMesh packed = pack(mesh);
  packed.error_estimated = static_cast<float>(error_world);
  writeMeshes({&packed, 1}, writer, progress);
}

}  // namespace tet4d::qslim4d
