#include "libpreprocess/qslim4d/cell_files.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <optional>
#include <type_traits>

#include "libpreprocess/outofcore/record_files.h"

namespace tet4d::qslim4d {
namespace {

using outofcore::BucketFiles;

constexpr std::size_t kReadBuffer = std::size_t{1} << 20;

static_assert(std::is_trivially_copyable_v<ResultHeader>);

// Terms are written and read as doubles.
constexpr std::size_t kQuadricDoubles = sizeof(Quadric) / sizeof(double),
                      kTermDoubles = sizeof(AttributeTerm) / sizeof(double);
static_assert(std::is_trivially_copyable_v<AttributeTerm> && kTermDoubles == 6);

// Vertices of all slots, each once, ascending; returns the local number of each slot.
std::vector<std::uint32_t> loadVertices(const std::string& path, LoadedCell& cell) {
  const std::vector<CellVertex> slots = outofcore::readRecords<CellVertex>(path);
  std::vector<std::uint32_t> order(slots.size()), local(slots.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return slots[a].id != slots[b].id ? slots[a].id < slots[b].id : a < b;
  });
  for (const std::uint32_t slot : order) {
    if (cell.ids.empty() || cell.ids.back() != slots[slot].id) {
      cell.ids.push_back(slots[slot].id);
      cell.positions.push_back(slots[slot].at);
      cell.flags.push_back(static_cast<std::uint8_t>(slots[slot].flags));
    }
    local[slot] = static_cast<std::uint32_t>(cell.ids.size() - 1);
  }
  return local;
}

// The local number of a vertex, or kNone.
std::uint32_t localOf(const LoadedCell& cell, std::uint64_t id) {
  const auto at = std::lower_bound(cell.ids.begin(), cell.ids.end(), id);
  return at != cell.ids.end() && *at == id ? static_cast<std::uint32_t>(at - cell.ids.begin()) : kNone;
}

// The values of each slot's vertex; those of a vertex with several slots are the same in all.
void loadValues(const std::string& path, const std::vector<std::uint32_t>& local, LoadedCell& cell) {
  for (SlimColumn& column : cell.columns.list) column.values.resize(cell.ids.size() * column.components);
  outofcore::RecordReader<float> reader(path, kReadBuffer);
  for (const std::uint32_t v : local) {
    for (SlimColumn& column : cell.columns.list)
      for (unsigned c = 0; c < column.components; ++c)
        reader.next(column.values[std::size_t{v} * column.components + c]);
  }
}

// The next vertex's, which are added to those of `v`; kNone: to nothing.
void addNextSums(outofcore::RecordReader<double>& reader, std::uint32_t v, Columns& columns) {
  std::array<double, kQuadricDoubles + kMostTerms * kTermDoubles> numbers{};
  const std::size_t count = kQuadricDoubles + columns.terms * kTermDoubles;
  for (std::size_t i = 0; i < count; ++i) reader.next(numbers[i]);
  if (v == kNone) return;
  Quadric squares;
  std::memcpy(static_cast<void*>(&squares), numbers.data(), sizeof squares);
  columns.squares[v].add(squares);
  for (std::size_t j = 0; j < columns.terms; ++j) {
    AttributeTerm term;
    std::memcpy(static_cast<void*>(&term), numbers.data() + kQuadricDoubles + j * kTermDoubles, sizeof term);
    AttributeTerm& sum = columns.sums[std::size_t{v} * columns.terms + j];
    sum.gradient += term.gradient, sum.offset += term.offset, sum.weight += term.weight;
  }
}

// Appends items to a file, some at a time.
template <class T>
class Appender {
 public:
  explicit Appender(const std::string& path) : path_(path) { items_.reserve(kWriteItems); }
  void add(const T& item) {
    if (items_.size() == kWriteItems) finish();
    items_.push_back(item);
  }
  void finish() {
    outofcore::appendFile(path_, std::as_bytes(std::span<const T>(items_)));
    items_.clear();
  }

 private:
  static constexpr std::size_t kWriteItems = 8192;
  const std::string& path_;
  std::vector<T> items_;
};

template <class T, class ItemOf>
void appendFor(const std::string& path, const std::vector<std::uint32_t>& vertices, const ItemOf& item_of) {
  Appender<T> items(path);
  for (const std::uint32_t v : vertices) items.add(item_of(v));
  items.finish();
}

}  // namespace

VertexLoad loadOf(std::span<const SlimColumn> columns) {
  VertexLoad load;
  std::size_t terms = 0;
  for (const SlimColumn& column : columns) {
    load.values += column.components;
    terms += column.weight == 0 ? 0 : column.components;
  }
  if (terms > 0) load.sums = kQuadricDoubles + terms * kTermDoubles;
  return load;
}

std::string PartTry::suffix() const {
  return (part == 0 ? "" : "-part" + std::to_string(part)) + (number == 0 ? "" : "-try" + std::to_string(number));
}

std::uint64_t loadBytes(std::uint64_t slots, std::uint64_t tets) {
  // Records, their order and local numbers; ids, positions and flags in vectors that double.
  return slots * (sizeof(CellVertex) + 8 + 2 * (8 + sizeof(Vec4f) + 1)) + tets * sizeof(hypermesh::Tet) + kReadBuffer;
}

LoadedCell loadCell(const CellPaths& paths, std::size_t cell_number, bool with_quadrics,
                    std::span<const SlimColumn> columns) {
  LoadedCell cell;
  cell.columns.list.assign(columns.begin(), columns.end());
  const VertexLoad load = loadOf(columns);
  {
    const std::string path = BucketFiles::pathOf(paths.tets(), cell_number);
    const std::vector<std::uint32_t> local = loadVertices(BucketFiles::pathOf(paths.vertices(), cell_number), cell);
    if (load.values > 0) loadValues(BucketFiles::pathOf(paths.values(), cell_number), local, cell);
    cell.tets.reserve(outofcore::fileBytes(path) / sizeof(hypermesh::Tet));
    outofcore::RecordReader<hypermesh::Tet> reader(path, kReadBuffer);
    for (hypermesh::Tet tet{}; reader.next(tet);)
      cell.tets.push_back({local[tet[0]], local[tet[1]], local[tet[2]], local[tet[3]]});
  }
  outofcore::RecordReader<std::uint64_t> shared(BucketFiles::pathOf(paths.shared(), cell_number), kReadBuffer);
  for (std::uint64_t id = 0; shared.next(id);) cell.flags[localOf(cell, id)] |= kLocked;
  if (!with_quadrics) return cell;
  cell.quadrics.resize(cell.ids.size());
  std::optional<outofcore::RecordReader<double>> sums;
  if (load.sums > 0) {
    cell.columns.terms = (load.sums - kQuadricDoubles) / kTermDoubles;
    cell.columns.squares.resize(cell.ids.size());
    cell.columns.sums.resize(cell.ids.size() * cell.columns.terms);
    sums.emplace(BucketFiles::pathOf(paths.sums(), cell_number), kReadBuffer);
  }
  outofcore::RecordReader<CellQuadric> quadrics(BucketFiles::pathOf(paths.quadrics(), cell_number), kReadBuffer);
  for (CellQuadric part{}; quadrics.next(part);) {
    // One whose vertex lost its last tetrahedron here may have been sent to a cell that does not know it.
    const std::uint32_t v = localOf(cell, part.id);
    if (v != kNone) cell.quadrics[v].add(part.quadric);
    if (sums) addNextSums(*sums, v, cell.columns);
  }
  return cell;
}

void removeCell(const CellPaths& paths, std::size_t cell) {
  for (const std::string& prefix :
       {paths.vertices(), paths.values(), paths.tets(), paths.quadrics(), paths.sums(), paths.shared()})
    outofcore::removeFile(BucketFiles::pathOf(prefix, cell));
}

void writeResult(const std::string& path, const SlimMesh& mesh, std::span<const std::uint64_t> ids, bool first,
                 const Stats& stats, const NonManifold& found) {
  // A locked vertex without a tetrahedron is kept: its part of the quadric belongs to the vertex in other cells.
  std::vector<std::uint32_t> kept, number(mesh.positions.size(), kNone);
  kept.reserve(mesh.live_vertices);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!mesh.isUsed(v)) continue;
    number[v] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(v);
  }
  ResultHeader header{};
  header.vertices = kept.size(), header.tets = mesh.live_tets, header.stats = stats;
  header.load = loadOf(mesh.columns.list), header.non_manifold = found;
  header.tets_in = mesh.tets.size();
  const auto locked = std::count_if(mesh.is_boundary.begin(), mesh.is_boundary.end(),
                                    [](std::uint8_t flags) { return (flags & kLocked) != 0; });
  header.free_share = 1 - static_cast<double>(locked) / static_cast<double>(std::max<std::size_t>(1, number.size()));
  outofcore::writeFile(path, std::as_bytes(std::span(&header, 1)));
  appendFor<std::uint64_t>(path, kept, [&](std::uint32_t v) { return ids[v]; });
  appendFor<Vec4f>(path, kept, [&](std::uint32_t v) { return mesh.positions[v]; });
  Appender<hypermesh::Tet> tets(path);
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    if (!mesh.isLive(t)) continue;
    const hypermesh::Tet& tet = mesh.tets[t];
    tets.add({number[tet[0]], number[tet[1]], number[tet[2]], number[tet[3]]});
  }
  tets.finish();
  appendFor<std::uint8_t>(path, kept, [&](std::uint32_t v) {
    const unsigned flags = mesh.is_boundary[v];
    const bool was_shared = (flags & kLocked) != 0 && (flags & kPinned) == 0;
    return was_shared && (first || (flags & kUncounted) != 0) ? std::uint8_t{kUncounted} : std::uint8_t{0};
  });
  Appender<float> values(path);
  for (const std::uint32_t v : kept) {
    for (const SlimColumn& column : mesh.columns.list)
      for (unsigned c = 0; c < column.components; ++c)
        values.add(column.values[std::size_t{v} * column.components + c]);
  }
  values.finish();
  appendFor<Quadric>(path, kept, [&](std::uint32_t v) { return mesh.quadrics[v]; });
  if (header.load.sums == 0) return;
  Appender<double> sums(path);
  const auto addNumbers = [&](const auto& item) {
    std::array<double, sizeof(item) / sizeof(double)> numbers{};
    std::memcpy(numbers.data(), &item, sizeof item);
    for (const double one : numbers) sums.add(one);
  };
  for (const std::uint32_t v : kept) {
    addNumbers(mesh.columns.squares[v]);
    for (std::size_t j = 0; j < mesh.columns.terms; ++j)
      addNumbers(mesh.columns.sums[std::size_t{v} * mesh.columns.terms + j]);
  }
  sums.finish();
}

ResultHeader readResultHeader(const std::string& path) {
  ResultHeader header{};
  outofcore::readAt(path, 0, std::as_writable_bytes(std::span(&header, 1)));
  return header;
}

CellResult readResult(const std::string& path, ResultWants wants) {
  CellResult result;
  result.header = readResultHeader(path);
  std::uint64_t offset = sizeof(ResultHeader);
  const auto read = [&]<class T>(std::vector<T>& items, std::uint64_t count) {
    items.resize(count);
    outofcore::readAt(path, offset, std::as_writable_bytes(std::span(items)));
    offset += count * sizeof(T);
  };
  read(result.ids, result.header.vertices);
  read(result.positions, result.header.vertices);
  read(result.tets, result.header.tets);
  read(result.flags, result.header.vertices);
  if (wants == ResultWants::kMesh) return result;
  read(result.values, result.header.vertices * result.header.load.values);
  if (wants == ResultWants::kValues) return result;
  read(result.quadrics, result.header.vertices);
  read(result.sums, result.header.vertices * result.header.load.sums);
  return result;
}

}  // namespace tet4d::qslim4d
