// hypermesh (.t4h): a tetrahedral 3-manifold in space-time. Ponchio & Hormann 2008, sec. 3.
//
// Pages are time slabs in time order. A page owns vertices — a contiguous range of the mesh's global vertex numbers —
// and tetrahedra. Its tetrahedra use u32 local indices: 0 .. owned-1 are its own vertices, then come the vertices of
// its runs of foreign vertices (global ranges owned by other pages), in order. Marching hypercubes writes one run per
// page: the vertices on the next frame's grid. No vertex is stored twice.
//
// A geometry page's bytes:  PageHeader (64 B) | vertices Vec4f[owned] | runs Run[runs] | tets u32[4][tets], each part
// padded with zeros to 64 bytes. entry.counts = {first_vertex, owned, tets, foreign vertices}.
// Each geometry page (entry.kind = 0) is followed by its column pages (entry.kind = 1 + c): column c of its own
// vertices, float32, zero-padded to 64 bytes. So page k * (1 + columns) of the table is geometry page k. Sections:
// HHDR, TIME (f64 per frame), COLS (optional), PAGE/PTAB. docs/formats/hypermesh.md.
//
// Orientation: see formats/core/tet_slice.h. Coordinates: index space, t in frames.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/columns.h"
#include "formats/core/coordinates.h"
#include "formats/paged.h"
#include "formats/parts.h"

namespace tet4d::hypermesh {

inline constexpr std::uint32_t kPayload = container::fourCc("HYPM");
inline constexpr std::uint16_t kVersion = 2;  // the newest that is read
inline constexpr std::uint32_t kHeader = container::fourCc("HHDR");
inline constexpr std::uint32_t kTimes = container::fourCc("TIME");
inline constexpr std::uint32_t kColumns = container::fourCc("COLS");
inline constexpr std::uint32_t kParts = container::fourCc("PART");

// Flags of a hypermesh.
inline constexpr std::uint32_t kOnGrid = 1u << 0;         // made from a grid: boundary only on the box's walls, unless:
inline constexpr std::uint32_t kInnerBoundary = 1u << 1;  // cells were masked (NaN): boundary inside the box is legal

struct MeshHeader {
  std::uint64_t vertices;     // @0
  std::uint64_t tets;         // @8
  std::uint64_t frames;       // @16  entries of TIME
  std::uint32_t flags;        // @24  kOnGrid …
  std::uint32_t columns;      // @28  entries of COLS
  AffineMap index_to_world;   // @32
  Bounds4f domain;            // @128 the box whose walls may bound the mesh (index space, frames)
  Bounds4f bounds;            // @160 of the vertices; all zero if there are none
  double isovalue;            // @192 NaN if there is none, or one for each part
  std::uint64_t parts;        // @200 entries of PART; 0: the mesh is one part
  std::uint64_t reserved[6];  // @208 zero
};
static_assert(sizeof(MeshHeader) == 256 && offsetof(MeshHeader, isovalue) == 192 &&
              offsetof(MeshHeader, domain) == 128);

using tet4d::ColumnEntry;
using tet4d::PartEntry;

struct PageHeader {
  std::uint64_t first_vertex;  // @0  global number of the page's first own vertex
  std::uint64_t owned;         // @8
  std::uint64_t tets;          // @16
  std::uint64_t runs;          // @24
  std::uint64_t foreign;       // @32 sum of the runs' counts
  std::uint64_t part;          // @40 entry of PART it belongs to; 0 without parts
  std::uint64_t reserved[2];   // @48 zero
};
static_assert(sizeof(PageHeader) == 64);

struct Run {
  std::uint64_t first;  // @0 global vertex number
  std::uint64_t count;  // @8 at least 1; runs ascend and do not overlap
};
static_assert(sizeof(Run) == 16);

using Tet = std::array<std::uint32_t, 4>;

// One geometry page, as spans over its bytes. Valid while the bytes are.
struct PageView {
  const PageHeader* header = nullptr;
  std::span<const Vec4f> vertices;  // own
  std::span<const Run> runs;
  std::span<const Tet> tets;  // local indices
  // Global number of a local index. O(runs); for MC files one step.
  std::uint64_t globalOf(std::uint32_t local) const;
};

// Spans over a page's bytes, proved: sizes, counts against `entry`, zero padding, finite vertices, runs disjoint from
// the page's own range and below `total_vertices`, every index in range. O(page).
Result<PageView> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry, const MeshHeader& mesh,
                              const std::string& file, std::size_t page);

// A page with the positions of its foreign vertices gathered: everything a consumer needs to use local indices.
struct GatheredPage {
  paged::PageBytes bytes;  // keeps the view alive
  PageView view;
  std::vector<Vec4f> positions;  // own vertices, then foreign ones: positions[local index]
};

class File {
 public:
  static Result<File> open(const std::string& path);
  const container::Reader& reader() const { return *reader_; }
  const MeshHeader& header() const { return *header_; }
  std::span<const double> times() const { return times_; }
  std::span<const ColumnEntry> columns() const { return columns_; }
  std::span<const PartEntry> parts() const { return parts_; }  // empty: the mesh is one part
  const paged::Pages& pages() const { return pages_; }
  // Geometry pages, in time order; they are every (1 + columns)-th page of the page table.
  std::size_t geometryPages() const { return pages_.size() / stride(); }
  const paged::PageEntry& geometryEntry(std::size_t k) const { return pages_.entries()[k * stride()]; }
  // A digest of what the file says (header, times, columns' names, decoded pages), the same for every codec and layout.
  Result<std::uint64_t> contentDigest() const;
  // Loads and proves geometry page k and gathers its foreign vertices from the pages that own them. O(page + owners).
  Result<GatheredPage> gather(std::size_t k) const;
  // The part that geometry page k belongs to; reads the page, but gathers nothing. O(page).
  Result<std::uint64_t> partOf(std::size_t k) const;
  // What gather(k) may hold at once: the page and an owner's decoded, and the positions. Bytes, without reading the
  // page.
  std::uint64_t gatherBytes(std::size_t k) const;
  // Column c for every local index of geometry page k, whose view is `page`: components floats each, own vertices
  // first, foreign ones from the columns of the pages that own them. O(page + owners), memory of one column page beside
  // it.
  Result<std::vector<float>> gatherColumn(std::size_t c, std::size_t k, const PageView& page) const;
  // Column c of geometry page k: components * owned floats.
  Result<paged::PageBytes> loadColumn(std::size_t c, std::size_t k) const;
  // Sections, padding, all pages and indices. O(file), memory of one page and its neighbours. Faces: topology/.
  Status verify() const;

 private:
  std::size_t stride() const { return 1 + columns_.size(); }
  Result<paged::PageBytes> loadPage(std::size_t k, PageView& view) const;
  std::unique_ptr<container::Reader> reader_;
  const MeshHeader* header_ = nullptr;
  std::span<const double> times_;
  std::span<const ColumnEntry> columns_;
  std::span<const PartEntry> parts_;
  paged::Pages pages_;
  std::uint64_t largest_decoded_ = 0;  // of the geometry pages: bytes that one takes when it is loaded
};

// Streams a hypermesh page by page, in time order. Vertices and counts of the header are filled in at close.
class Writer {
 public:
  using Column = tet4d::Column;
  // header: flags, index_to_world, domain, isovalue; the rest is filled in. times: one per frame. part_isovalues: one a
  // part, none for a mesh of one part.
  static Result<Writer> create(const std::string& path, const MeshHeader& header, std::span<const double> times,
                               std::span<const Column> columns, paged::Codec codec, bool force,
                               std::span<const double> part_isovalues = {});
  // Adds a slab of a part (an empty one is legal and keeps the rank). Raw pages are written from the spans, uncopied.
  // bounds: a box that holds all vertices its tetrahedra use, own or foreign; its t does not begin before that of the
  // page in front. columns: one span per declared column, components * vertices.size() floats.
  Status addPage(std::span<const Vec4f> vertices, std::span<const Run> runs, std::span<const Tet> tets,
                 const Bounds4f& bounds, std::span<const std::span<const float>> columns = {}, std::uint64_t part = 0);
  // What a stream tells only at its end: the times, replacing those of create(), and the domain's last time.
  Status setTimes(std::span<const double> times, float last_t);
  // Sets flags of the header that only the data can tell, such as kInnerBoundary. Any time before close.
  void addFlags(std::uint32_t flags) { header_.flags |= flags; }
  // The domain where only the data tell it. Any time before close; close() checks it.
  void setDomain(const Bounds4f& domain) { header_.domain = domain; }
  // Errors of the next page, world units, in place of 0 and -1 (paged::PageEntry).
  void setPageErrors(float estimated, float measured) { error_estimated_ = estimated, error_measured_ = measured; }
  std::uint64_t nextVertex() const { return next_vertex_; }
  std::uint64_t tets() const { return tets_; }
  Status close(const std::string& provenance_json);

 private:
  std::unique_ptr<container::Writer> file_;
  std::unique_ptr<paged::PageWriter> pages_;
  MeshHeader header_{};
  std::vector<double> times_;
  std::vector<ColumnEntry> columns_;
  std::vector<PartEntry> parts_;
  std::uint64_t next_vertex_ = 0, tets_ = 0;
  Bounds4f bounds_;
  float error_estimated_ = 0, error_measured_ = -1;  // of the next page
};

}  // namespace tet4d::hypermesh
