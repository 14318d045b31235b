// Ponchio & Hormann, "Interactive Rendering of Dynamic Geometry", TVCG 2008, sec. 7.1.
#include "libpreprocess/dyntri/dynamic_triangles_builder.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include "formats/core/tet_slice.h"
#include "libpreprocess/error.h"

namespace tet4d::dyntri {
namespace {

using EdgeKey = std::uint64_t;  // earlier vertex in the high half, later one in the low half

struct RawTriangle {
  std::array<EdgeKey, 3> edges;
  Lifespan life;
};

// The triangles of one tetrahedron that live at all.
void appendTriangles(const hypermesh::Tet& tet, std::span<const Vec4f> positions, std::vector<RawTriangle>& out) {
  const auto time = [&](std::size_t i) { return positions[tet[i]].t; };
  const TimeOrder order = orderByTime(time(0), time(1), time(2), time(3));
  for (const DynTriRule& rule : kDynTriRules) {
    const Lifespan life{time(order.at[rule.begin]), time(order.at[rule.end])};
    if (!(life.begin < life.end)) continue;
    RawTriangle triangle{{}, life};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& ends = kTetEdges[rule.edges[c]];
      triangle.edges[c] = EdgeKey{tet[order.at[ends[0]]]} << 32 | tet[order.at[ends[1]]];
    }
    if (order.odd) std::swap(triangle.edges[1], triangle.edges[2]);
    out.push_back(triangle);
  }
}

// Numbers keys 0, 1, … in the order in which they first appear: open addressing with linear probing, at most half full.
// The numbers depend on the order of the calls alone, never on where the keys come to lie.
class FirstUse {
 public:
  FirstUse() : slots_(std::size_t{1} << kFirstBits, Slot{kFree, 0}) {}
  // The number of `key`; `fresh` says that it was given just now.
  std::uint32_t number(EdgeKey key, bool& fresh) {
    std::size_t at = place(key);
    fresh = slots_[at].key == kFree;
    if (!fresh) return slots_[at].number;
    if (2 * (std::size_t{next_} + 1) > slots_.size()) {
      grow();
      at = place(key);
    }
    slots_[at] = {key, next_};
    return next_++;
  }
  // Bytes held at most for so many keys, while the table grows too.
  static std::uint64_t boundMemory(std::uint64_t keys) {
    return (std::max<std::uint64_t>(4 * keys, 1U << kFirstBits) * 3 / 2) * sizeof(Slot);
  }

 private:
  // No edge joins the last possible vertex to itself.
  static constexpr EdgeKey kFree = std::numeric_limits<EdgeKey>::max();
  static constexpr unsigned kFirstBits = 10;
  struct Slot {
    EdgeKey key;
    std::uint32_t number;
  };

  std::size_t place(EdgeKey key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (key ^ key >> 29) * 0x9E3779B97F4A7C15U >> 20 & mask;
    while (slots_[at].key != kFree && slots_[at].key != key) at = (at + 1) & mask;
    return at;
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size(), {kFree, 0});
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != kFree) slots_[place(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::uint32_t next_ = 0;
};

}  // namespace

BuiltPage buildPage(std::span<const hypermesh::Tet> tets, std::span<const Vec4f> positions) {
  std::vector<RawTriangle> raw;
  raw.reserve(3 * tets.size());
  for (const hypermesh::Tet& tet : tets) appendTriangles(tet, positions, raw);
  std::stable_sort(raw.begin(), raw.end(),
                   [](const RawTriangle& a, const RawTriangle& b) { return a.life.begin < b.life.begin; });

  FirstUse edge_numbers;
  BuiltPage page;
  page.tets = tets.size();
  page.empty = boundTriangles(tets.size()) - raw.size();
  page.lifespans.reserve(raw.size());
  page.triangles.reserve(raw.size());
  // Vertices are few and their numbers dense: a plain table names them.
  std::vector<std::uint32_t> vertex_number(positions.size(), std::numeric_limits<std::uint32_t>::max());
  const auto vertexNumber = [&](std::uint64_t local) {
    std::uint32_t& number = vertex_number[local];
    if (number == std::numeric_limits<std::uint32_t>::max()) {
      number = static_cast<std::uint32_t>(page.vertices.size());
      page.vertices.push_back(positions[local]);
    }
    return number;
  };
  for (const RawTriangle& triangle : raw) {
    Triangle corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      bool fresh = false;
      corners[c] = edge_numbers.number(triangle.edges[c], fresh);
      if (!fresh) continue;
      const std::uint32_t a = vertexNumber(triangle.edges[c] >> 32);
      page.edges.push_back({a, vertexNumber(triangle.edges[c] & 0xFFFFFFFFu)});
    }
    page.triangles.push_back(corners);
    page.lifespans.push_back(triangle.life);
  }
  return page;
}

std::uint64_t boundPageMemory(std::uint64_t tets, std::uint64_t vertices) {
  // Raw triangles and the buffer of the stable sort (whose place the encoded page takes later), the page itself, the
  // table of edges, of which a tetrahedron has six.
  const std::uint64_t per_triangle = 2 * sizeof(RawTriangle) + sizeof(Lifespan) + sizeof(Triangle);
  return boundTriangles(tets) * per_triangle + 2 * 6 * tets * sizeof(Edge) + FirstUse::boundMemory(6 * tets) +
         vertices * (2 * sizeof(Vec4f) + 4) + tets * sizeof(hypermesh::Tet);
}

std::uint64_t boundBuildMemory(const hypermesh::File& mesh, std::size_t pages_in_flight) {
  std::vector<std::uint64_t> pages;
  for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
    const auto& counts = mesh.geometryEntry(k).counts;
    pages.push_back(boundPageMemory(counts[2], counts[1] + counts[3]));
  }
  const auto n = static_cast<std::ptrdiff_t>(std::min(pages_in_flight, pages.size()));
  std::partial_sort(pages.begin(), pages.begin() + n, pages.end(), std::greater<>());
  return std::accumulate(pages.begin(), pages.begin() + n, std::uint64_t{0});
}

BuildStats buildDynamicTriangles(const hypermesh::File& mesh, Writer& writer, outofcore::Executor& executor,
                                 outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  BuildStats stats;
  const std::size_t pages = mesh.geometryPages();
  std::size_t in_flight = executor.threads();
  while (in_flight > 1 && boundBuildMemory(mesh, in_flight) > memory.available()) --in_flight;
  const auto reserved = memory.reserve(boundBuildMemory(mesh, in_flight), "building the largest pages");
  progress.phase("build", pages);
  std::vector<BuiltPage> window(in_flight);
  for (std::size_t first = 0; first < pages; first += window.size()) {
    const std::size_t count = std::min(window.size(), pages - first);
    executor.run(count, [&](std::size_t i) {
      const auto gathered = unwrap(mesh.gather(first + i));
      window[i] = buildPage(gathered.view.tets, gathered.positions);
    });
    for (std::size_t i = 0; i < count; ++i) {
      BuiltPage& page = window[i];
      unwrap(writer.addPage(page.view(), page.tets, page.empty));
      stats.pages += 1;
      stats.tets += page.tets;
      stats.vertices += page.vertices.size();
      stats.edges += page.edges.size();
      stats.triangles += page.triangles.size();
      stats.empty += page.empty;
      page = {};
      progress.step(first + i + 1);
    }
  }
  return stats;
}

}  // namespace tet4d::dyntri
