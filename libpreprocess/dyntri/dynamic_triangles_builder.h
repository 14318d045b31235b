// Tetrahedra of a hypermesh → dynamic triangles: what the player draws. Ponchio & Hormann 2008, sec. 7.1, flat.
//
// Each tetrahedron, sorted by time, gives up to four triangles with half-open lifespans (formats/core/tet_slice.h);
// those whose lifespan is empty are dropped, so an edge of constant time is never emitted. Edges are unique within a
// page and numbered by first use in the order the triangles are drawn, vertices by first use in the order of the edges.
//
// The triangles of a page are sorted into bands of lifespans about as long (lifespan_bands.h), within a band by the
// interval of their begin, within an interval for caches of slice vertices (cache_order.h). Columns of the hypermesh
// follow its vertices.
//
// Cost: one pass over the pages; O(n) in a page's triangles; memory of as many pages as there are threads, fewer if the
// budget says so, at least one. The bytes depend on neither.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "formats/hypermesh.h"
#include "libpreprocess/dyntri/lifespan_bands.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::dyntri {

struct BuildOptions {
  std::uint32_t bands = kDefaultBands;  // at most so many a page, 1 .. kMostBands
  std::vector<std::size_t> columns;     // of the hypermesh, those to carry
};

// One page, built in memory.
struct BuiltPage {
  std::vector<Vec4f> vertices;
  std::vector<Edge> edges;
  std::vector<Lifespan> lifespans;
  std::vector<Triangle> triangles;
  std::vector<Band> bands;
  std::vector<Alive> index;
  Lifespan interval{};
  std::vector<std::uint32_t> locals;        // of the vertices: their indices into the positions given
  std::vector<std::vector<float>> columns;  // components * vertices each
  std::uint64_t part = 0;
  std::uint64_t tets = 0;   // it was made from
  std::uint64_t empty = 0;  // triangles dropped: 4 * tets = triangles + empty
  PageView view() const { return {vertices, edges, lifespans, triangles, bands, index, interval, part}; }
};

struct BuildStats {
  std::uint64_t pages = 0, tets = 0, vertices = 0, edges = 0, triangles = 0, empty = 0;
  std::uint64_t band_bytes = 0;  // of bands and their index
  void add(const BuiltPage& page);
};

// The most triangles that so many tetrahedra can give.
constexpr std::uint64_t boundTriangles(std::uint64_t tets) { return 4 * tets; }

// Bytes held at most while a page of so many tetrahedra and vertices is built (all arrays together).
std::uint64_t boundPageMemory(std::uint64_t tets, std::uint64_t vertices);

// Builds one page, without columns. tets: indices into positions; positions: index space, t in frames, finite.
BuiltPage buildPage(std::span<const hypermesh::Tet> tets, std::span<const Vec4f> positions,
                    std::uint32_t bands = kDefaultBands);

// Bytes that building `mesh` on so many threads reserves: of its largest pages, as many as are in flight.
std::uint64_t boundBuildMemory(const hypermesh::File& mesh, std::size_t pages_in_flight, const BuildOptions& options);

// Converts a whole hypermesh, page by page in time order, into `writer` (not closed here). Phase: "build" (pages are
// read, built and written in it). Throws Error for a damaged page, kOutOfMemory if not even one page fits the budget.
// `writer` was created with the columns and parts chosen.
BuildStats buildDynamicTriangles(const hypermesh::File& mesh, const BuildOptions& options, Writer& writer,
                                 outofcore::Executor& executor, outofcore::MemoryBudget& memory,
                                 outofcore::Progress& progress);

}  // namespace tet4d::dyntri
