#include "libpreprocess/qslim4d/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "libpreprocess/column_list.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"
#include "libpreprocess/exchange/slice_columns.h"
#include "libpreprocess/outofcore/huge_pages.h"
#include "libpreprocess/qslim4d/attributes.h"
#include "libpreprocess/qslim4d/orders.h"
#include "libpreprocess/qslim4d/part_pages.h"

namespace tet4d::qslim4d {
namespace {

constexpr std::uint64_t kMostTets = std::uint64_t{3} << 28;  // corners, and room for more, have u32 numbers
constexpr double kRangeInCells = 10;                         // of a column in the metric without a weight

void checkSize(const hypermesh::File& file) {
  const hypermesh::MeshHeader& header = file.header();
  if (header.vertices < kNone && header.tets < kMostTets) return;
  throw Error(FaultCode::kBadInput, file.reader().path(), "",
              "has " + std::to_string(header.vertices) + " vertices and " + std::to_string(header.tets) +
                  " tetrahedra, too many to simplify in core (2^32 - 2 and 2^29 + 2^28 - 1)",
              "simplify it in cells: --order passes or multichoice, and a smaller --cell-tets");
}

// The numbers a part's vertices get: those of its pages in a row.
class PartNumbers {
 public:
  PartNumbers(const hypermesh::File& file, const PartPages& parts, std::size_t part) : pages_(parts.pages(part)) {
    for (const std::size_t k : pages_) {
      const auto& counts = file.geometryEntry(k).counts;
      ranges_.push_back({counts[0], counts[1], vertices_});
      vertices_ += counts[1];
    }
    tets_ = parts.tets(part);
  }
  const std::vector<std::size_t>& pages() const { return pages_; }
  std::uint64_t vertices() const { return vertices_; }
  std::uint64_t tets() const { return tets_; }
  // kNone for a vertex of another part.
  std::uint32_t of(std::uint64_t global) const {
    const auto after = std::upper_bound(ranges_.begin(), ranges_.end(), global,
                                        [](std::uint64_t n, const Range& range) { return n < range.first; });
    if (after == ranges_.begin() || global - std::prev(after)->first >= std::prev(after)->count) return kNone;
    return static_cast<std::uint32_t>(std::prev(after)->local + global - std::prev(after)->first);
  }

 private:
  struct Range {
    std::uint64_t first, count, local;
  };
  const std::vector<std::size_t>& pages_;
  std::vector<Range> ranges_;
  std::uint64_t vertices_ = 0, tets_ = 0;
};

struct Arrays {
  std::vector<Vec4f> positions;
  std::vector<hypermesh::Tet> tets;
  std::vector<std::vector<float>> columns;
};

std::span<const float> floatsOf(const paged::PageBytes& bytes, std::size_t count) {
  return {reinterpret_cast<const float*>(bytes.bytes().data()), count};
}

Arrays readPages(const hypermesh::File& file, const PartNumbers& numbers, const std::vector<PlannedColumn>& columns,
                 outofcore::Progress& progress) {
  Arrays arrays;
  outofcore::reserveHuge(arrays.positions, numbers.vertices());
  outofcore::reserveHuge(arrays.tets, numbers.tets());
  for (const PlannedColumn& column : columns)
    arrays.columns.emplace_back().reserve(numbers.vertices() * column.as.components);
  std::vector<std::uint32_t> locals;
  std::size_t done = 0;
  for (const std::size_t k : numbers.pages()) {
    const hypermesh::GatheredPage page = unwrap(file.gather(k));
    arrays.positions.insert(arrays.positions.end(), page.view.vertices.begin(), page.view.vertices.end());
    locals.clear();
    for (const std::uint64_t global : exchange::globalNumbers(page.view)) locals.push_back(numbers.of(global));
    for (const hypermesh::Tet& tet : page.view.tets) {
      hypermesh::Tet& named = arrays.tets.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) named[i] = locals[tet[i]];
      if (std::find(named.begin(), named.end(), kNone) == named.end()) continue;
      throw Error(FaultCode::kBadInput, file.reader().path(), "page " + std::to_string(k),
                  "a tetrahedron has a vertex of another part", "make the file again");
    }
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const paged::PageBytes bytes = unwrap(file.loadColumn(columns[c].column, k));
      const auto values = floatsOf(bytes, page.view.vertices.size() * columns[c].as.components);
      arrays.columns[c].insert(arrays.columns[c].end(), values.begin(), values.end());
    }
    file.reader().dropResident();
    progress.step(++done);
  }
  return arrays;
}

}  // namespace

std::uint64_t simplifyBytes(std::uint64_t vertices, std::uint64_t tets) {
  return slimMeshBytes(vertices, tets) + orderBytes(vertices, tets);
}

std::uint64_t boundMemory(const hypermesh::File& file, std::span<const ColumnWish> columns) {
  const hypermesh::MeshHeader& header = file.header();
  std::uint64_t page = 0, column_bytes = 0, terms = 0;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) page = std::max(page, file.gatherBytes(k));
  for (const ColumnWish& wish : columns) {
    const std::uint64_t components = file.columns()[wish.column].components;
    column_bytes += 2 * sizeof(float) * components;  // as they are, and packed
    terms += wish.in_metric ? components : 0;
  }
  if (terms > 0) column_bytes += sizeof(Quadric) + terms * sizeof(AttributeTerm);
  const std::uint64_t read = header.vertices * sizeof(Vec4f) + header.tets * sizeof(hypermesh::Tet) + page;
  return std::max({read, simplifyBytes(header.vertices, header.tets), packBytes(header.vertices, header.tets)}) +
         header.vertices * column_bytes;
}

std::vector<PlannedColumn> planColumns(const hypermesh::File& file, std::span<const ColumnWish> wishes,
                                       outofcore::Progress& progress) {
  std::vector<PlannedColumn> planned;
  if (wishes.empty()) return planned;
  progress.phase("columns", wishes.size());
  const double cell = spaceOf(file.header().index_to_world).cell;
  for (const ColumnWish& wish : wishes) {
    const ColumnEntry& entry = file.columns()[wish.column];
    SlimColumn column;
    column.name = columnName(entry);
    column.components = entry.components;
    bool is_whole = true, is_empty = true;
    column.low.fill(std::numeric_limits<float>::max());
    column.high.fill(std::numeric_limits<float>::lowest());
    for (std::size_t k = 0; k < file.geometryPages(); ++k) {
      const std::size_t n = column.components, vertices = file.geometryEntry(k).counts[1];
      if (vertices == 0) continue;
      const paged::PageBytes bytes = unwrap(file.loadColumn(wish.column, k));
      const auto values = floatsOf(bytes, vertices * n);
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) continue;
        is_empty = false;
        is_whole = is_whole && values[i] == std::nearbyint(values[i]);
        column.low[i % n] = std::min(column.low[i % n], values[i]);
        column.high[i % n] = std::max(column.high[i % n], values[i]);
      }
    }
    double range = 0;
    for (std::size_t c = 0; c < column.components && !is_empty; ++c)
      range = std::max(range, double{column.high[c]} - column.low[c]);
    if (column.name == exchange::kNormal && column.components == 3) {
      column.kind = ColumnKind::kNormal;
    } else if (is_whole && !wish.in_metric) {
      column.kind = ColumnKind::kLabel;
    }
    // A constant says nothing, and would take memory to say it.
    if (wish.in_metric && range > 0) column.weight = wish.weight ? *wish.weight / cell : kRangeInCells / range;
    planned.push_back({wish.column, std::move(column)});
    progress.step(planned.size());
  }
  return planned;
}

SlimMesh readMesh(const hypermesh::File& file, const ReadOptions& options, outofcore::Progress& progress,
                  NonManifold* found) {
  checkSize(file);
  const PartPages parts(file);
  const PartNumbers numbers(file, parts, options.part);
  progress.phase("read", numbers.pages().size());
  Arrays arrays = readPages(file, numbers, options.columns, progress);
  try {
    SlimMesh mesh = makeSlimMesh(std::move(arrays.positions), std::move(arrays.tets), file.header().domain,
                                 file.header().index_to_world, options.metric,
                                 {options.keep_non_manifold, options.executor, nullptr});
    if (options.keep_non_manifold) {
      const NonManifold places = lockNonManifold(mesh);
      if (found != nullptr) *found = places;
    }
    for (std::size_t c = 0; c < options.columns.size(); ++c) {
      mesh.columns.list.push_back(options.columns[c].as);
      mesh.columns.list.back().values = std::move(arrays.columns[c]);
    }
    addAttributeQuadrics(mesh, options.metric);
    return mesh;
  } catch (const Error& error) {
    Fault fault = error.fault();
    if (fault.file.empty() && fault.code == FaultCode::kBadInput) fault.file = file.reader().path();
    throw Error(fault);
  }
}

std::vector<std::uint64_t> tetsByPart(const hypermesh::File& file) {
  if (file.parts().empty()) return {file.header().tets};
  std::vector<std::uint64_t> tets(file.parts().size());
  for (std::size_t k = 0; k < file.geometryPages(); ++k)
    tets[unwrap(file.partOf(k))] += file.geometryEntry(k).counts[2];
  return tets;
}

}  // namespace tet4d::qslim4d
