// Ponchio & Hormann, "Interactive Rendering of Dynamic Geometry", TVCG 2008, sec. 7.1.
#include "libpreprocess/dyntri/dynamic_triangles_builder.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include "formats/core/tet_slice.h"
#include "libpreprocess/dyntri/cache_order.h"
#include "libpreprocess/dyntri/edge_numbers.h"
#include "libpreprocess/dyntri/lifespan_bands.h"
#include "libpreprocess/error.h"

namespace tet4d::dyntri {
namespace {

// What bands and index may take of a page, and what a page takes however small it is.
constexpr std::uint64_t kBandBytesATet = 4, kFixedBytes = 16384;

// The triangles of a page in the order of its tetrahedra.
struct RawTriangles {
  std::vector<Triangle> triangles;  // edges by EdgeNumbers
  std::vector<Lifespan> lives;
};

// How many triangles live at all, so that nothing grows.
std::uint64_t countTriangles(std::span<const hypermesh::Tet> tets, std::span<const Vec4f> positions) {
  std::uint64_t count = 0;
  for (const hypermesh::Tet& tet : tets) {
    const auto time = [&](std::size_t i) { return positions[tet[i]].t; };
    const TimeOrder order = orderByTime(time(0), time(1), time(2), time(3));
    for (const DynTriRule& rule : kDynTriRules) count += time(order.at[rule.begin]) < time(order.at[rule.end]) ? 1 : 0;
  }
  return count;
}

// The triangles of one tetrahedron that live at all.
void appendTriangles(const hypermesh::Tet& tet, std::span<const Vec4f> positions, EdgeNumbers& edges,
                     RawTriangles& out) {
  const auto time = [&](std::size_t i) { return positions[tet[i]].t; };
  const TimeOrder order = orderByTime(time(0), time(1), time(2), time(3));
  constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();
  std::array<std::uint32_t, 6> numbers{};  // of the tetrahedron's edges, asked for when a triangle needs them
  numbers.fill(kUnknown);
  for (const DynTriRule& rule : kDynTriRules) {
    const Lifespan life{time(order.at[rule.begin]), time(order.at[rule.end])};
    if (!(life.begin < life.end)) continue;
    Triangle triangle{};
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& number = numbers[rule.edges[c]];
      const auto& ends = kTetEdges[rule.edges[c]];
      if (number == kUnknown) number = edges.number(tet[order.at[ends[0]]], tet[order.at[ends[1]]]);
      triangle[c] = number;
    }
    if (order.odd) std::swap(triangle[1], triangle[2]);
    out.triangles.push_back(triangle);
    out.lives.push_back(life);
  }
}

// Puts triangles and lifespans into the page in the order of their buckets, those of a bucket as they came. Returns
// where each bucket ends.
std::vector<std::uint64_t> sortByBucket(const RawTriangles& raw, std::span<const std::uint32_t> bucket,
                                        std::size_t buckets, BuiltPage& page) {
  std::vector<std::uint64_t> place(buckets + 1);
  for (const std::uint32_t b : bucket) ++place[b + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  page.lifespans.resize(raw.lives.size());
  page.triangles.resize(raw.triangles.size());
  for (std::size_t i = 0; i < bucket.size(); ++i) {
    const std::uint64_t to = place[bucket[i]]++;
    page.lifespans[to] = raw.lives[i];
    page.triangles[to] = raw.triangles[i];
  }
  place.resize(buckets);
  return place;
}

// Orders the triangles of each bucket for vertex caches.
void orderBuckets(std::span<const std::uint64_t> ends, std::size_t edges, BuiltPage& page) {
  std::size_t first = 0, longest = 0;
  for (const std::size_t end : ends) longest = std::max(longest, end - first), first = end;
  CacheOrder cache(edges, longest);
  std::vector<Triangle> triangles;
  std::vector<Lifespan> lives;
  triangles.reserve(longest);
  lives.reserve(longest);
  first = 0;
  for (const std::size_t end : ends) {
    const auto of_bucket = std::span(page.triangles).subspan(first, end - first);
    const auto lives_of_bucket = std::span(page.lifespans).subspan(first, end - first);
    first = end;
    if (of_bucket.size() < 3) continue;  // any order is as good
    triangles.assign(of_bucket.begin(), of_bucket.end());
    lives.assign(lives_of_bucket.begin(), lives_of_bucket.end());
    std::size_t to = 0;
    for (const std::uint32_t i : cache.order(triangles)) {
      of_bucket[to] = triangles[i];
      lives_of_bucket[to++] = lives[i];
    }
  }
}

// Numbers edges and vertices anew, by first use in the order of the triangles.
void numberByUse(std::span<const Edge> edges, std::span<const Vec4f> positions, BuiltPage& page) {
  constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> edge_number(edges.size(), kUnknown), vertex_number(positions.size(), kUnknown);
  page.edges.reserve(edges.size());
  const auto vertexNumber = [&](std::uint32_t local) {
    std::uint32_t& number = vertex_number[local];
    if (number == kUnknown) {
      number = static_cast<std::uint32_t>(page.vertices.size());
      page.vertices.push_back(positions[local]);
      page.locals.push_back(local);
    }
    return number;
  };
  for (Triangle& triangle : page.triangles) {
    for (std::uint32_t& edge : triangle) {
      std::uint32_t& number = edge_number[edge];
      if (number == kUnknown) {
        number = static_cast<std::uint32_t>(page.edges.size());
        const std::uint32_t a = vertexNumber(edges[edge].a);
        page.edges.push_back({a, vertexNumber(edges[edge].b)});
      }
      edge = number;
    }
  }
}

// Column c of the page's vertices, from that of the hypermesh's page.
std::vector<float> pickRows(std::span<const float> values, std::span<const std::uint32_t> locals,
                            std::size_t components) {
  std::vector<float> rows;
  rows.reserve(locals.size() * components);
  for (const std::uint32_t local : locals) {
    const auto row = values.subspan(local * components, components);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

// One page of the hypermesh, with the columns chosen.
BuiltPage buildPageOf(const hypermesh::File& mesh, std::size_t k, const BuildOptions& options) {
  const auto gathered = unwrap(mesh.gather(k));
  BuiltPage page = buildPage(gathered.view.tets, gathered.positions, options.bands);
  page.part = gathered.view.header->part;
  for (const std::size_t c : options.columns) {
    const auto values = unwrap(mesh.gatherColumn(c, k, gathered.view));
    page.columns.push_back(pickRows(values, page.locals, mesh.columns()[c].components));
  }
  return page;
}

// Bytes that a column page takes decoded, at most: of each of the columns.
std::vector<std::uint64_t> decodedColumnBytes(const hypermesh::File& mesh, std::span<const std::size_t> columns) {
  std::vector<std::uint64_t> most(columns.size());
  const std::size_t stride = 1 + mesh.columns().size();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
      const paged::PageEntry& entry = mesh.pages().entries()[k * stride + 1 + columns[i]];
      if (entry.codec != static_cast<std::uint32_t>(paged::Codec::kRaw)) most[i] = std::max(most[i], entry.raw_bytes);
    }
  }
  return most;
}

// Bytes of a page's columns: as gathered one by one, and as the page keeps them all.
std::uint64_t boundColumnMemory(const hypermesh::File& mesh, std::uint64_t vertices,
                                std::span<const std::size_t> columns, std::span<const std::uint64_t> decoded) {
  std::uint64_t kept = 0, gathered = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::uint64_t bytes = vertices * mesh.columns()[columns[i]].components * sizeof(float);
    kept += bytes;
    gathered = std::max(gathered, bytes + decoded[i]);
  }
  return kept + gathered;
}

}  // namespace

BuiltPage buildPage(std::span<const hypermesh::Tet> tets, std::span<const Vec4f> positions, std::uint32_t bands) {
  BuiltPage page;
  page.tets = tets.size();
  EdgeNumbers edges(positions.size());
  std::vector<std::uint64_t> ends;  // of the buckets
  {
    RawTriangles raw;
    const std::uint64_t count = countTriangles(tets, positions);
    raw.triangles.reserve(count);
    raw.lives.reserve(count);
    for (const hypermesh::Tet& tet : tets) appendTriangles(tet, positions, edges, raw);
    page.empty = boundTriangles(tets.size()) - count;
    page.interval = unionOf(raw.lives);
    BandPlan plan = planBands(raw.lives, page.interval, bands, kBandBytesATet * tets.size());
    page.bands = std::move(plan.bands);
    ends = sortByBucket(raw, plan.bucket, plan.buckets, page);
  }
  orderBuckets(ends, edges.edges().size(), page);
  numberByUse(edges.edges(), positions, page);
  page.index = indexBands(page.bands, page.lifespans, page.interval);
  return page;
}

void BuildStats::add(const BuiltPage& page) {
  pages += 1;
  tets += page.tets;
  vertices += page.vertices.size();
  edges += page.edges.size();
  triangles += page.triangles.size();
  empty += page.empty;
  band_bytes += page.bands.size() * sizeof(Band) + page.index.size() * sizeof(Alive);
}

std::uint64_t boundPageMemory(std::uint64_t tets, std::uint64_t vertices) {
  // As built and as sorted, with a bucket each, or as sorted and ordered, which takes more; the encoded page and its
  // copy take the place of the former later. Of edges a tetrahedron has six: the table of their numbers, then their
  // states while triangles are ordered, or those of the page and their new numbers.
  const std::uint64_t per_triangle = 2 * (sizeof(Lifespan) + sizeof(Triangle)) + CacheOrder::kBytesATriangle;
  const std::uint64_t edges = 6 * tets;
  return boundTriangles(tets) * per_triangle + EdgeNumbers::boundMemory(edges, vertices) +
         edges * std::max(sizeof(Edge) + 4, CacheOrder::kBytesAnEdge) + vertices * (3 * sizeof(Vec4f) + 3 * 4 + 4) +
         4 * kBandBytesATet * tets + kFixedBytes;
}

std::uint64_t boundBuildMemory(const hypermesh::File& mesh, std::size_t pages_in_flight, const BuildOptions& options) {
  const std::vector<std::uint64_t> decoded = decodedColumnBytes(mesh, options.columns);
  std::vector<std::uint64_t> pages;
  for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
    const auto& counts = mesh.geometryEntry(k).counts;
    const std::uint64_t vertices = counts[1] + counts[3];
    pages.push_back(boundPageMemory(counts[2], vertices) + mesh.gatherBytes(k) +
                    boundColumnMemory(mesh, vertices, options.columns, decoded));
  }
  const auto n = static_cast<std::ptrdiff_t>(std::min(pages_in_flight, pages.size()));
  std::partial_sort(pages.begin(), pages.begin() + n, pages.end(), std::greater<>());
  return std::accumulate(pages.begin(), pages.begin() + n, std::uint64_t{0});
}

BuildStats buildDynamicTriangles(const hypermesh::File& mesh, const BuildOptions& options, Writer& writer,
                                 outofcore::Executor& executor, outofcore::MemoryBudget& memory,
                                 outofcore::Progress& progress) {
  BuildStats stats;
  const std::size_t pages = mesh.geometryPages();
  std::size_t in_flight = executor.threads();
  while (in_flight > 1 && boundBuildMemory(mesh, in_flight, options) > memory.available()) --in_flight;
  const auto reserved = memory.reserve(boundBuildMemory(mesh, in_flight, options), "building the largest pages");
  progress.phase("build", pages);
  std::vector<BuiltPage> window(in_flight);
  for (std::size_t first = 0; first < pages; first += window.size()) {
    const std::size_t count = std::min(window.size(), pages - first);
    executor.run(count, [&](std::size_t i) { window[i] = buildPageOf(mesh, first + i, options); });
    for (std::size_t i = 0; i < count; ++i) {
      BuiltPage& page = window[i];
      const std::vector<std::span<const float>> columns(page.columns.begin(), page.columns.end());
      unwrap(writer.addPage(page.view(), page.tets, page.empty, columns));
      stats.add(page);
      page = {};
      progress.step(first + i + 1);
    }
  }
  return stats;
}

}  // namespace tet4d::dyntri
