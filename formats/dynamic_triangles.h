// dynamic_triangles (.t4d): what the player draws. Ponchio & Hormann 2008, sec. 7.1; flat, one level of pages.
//
// A page stands alone: it maps and draws without any other. Its bytes:
//   PageHeader (64 B) | vertices Vec4f[v] | edges Edge[e] | lifespans Lifespan[n] | triangles u32[3][n]
//   | bands Band[b] | index Alive[i]
// each part padded with zeros to 64 bytes. entry.counts = {vertices, edges, triangles, 0}; entry.bounds.t = the union
// of the lifespans. An edge runs forward in time (vertices[a].t < vertices[b].t): edges of constant time do not exist.
// A triangle's lifespan is [begin, end) — closed at the file's last time — and equals the intersection of its edges'
// intervals. Bands are runs of triangles whose lives are about as long; a band cuts the page's time into equal
// intervals and says of each which of its triangles can be alive then. A page without bands (version 1) is one run,
// sorted by begin.
// Each geometry page (entry.kind = 0) is followed by its column pages (entry.kind = 1 + c), as in a hypermesh: column c
// of its vertices. Sections: DHDR, TIME, COLS and PART (optional), PAGE/PTAB. docs/formats/dynamic_triangles.md.
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

namespace tet4d::dyntri {

inline constexpr std::uint32_t kPayload = container::fourCc("DYNT");
inline constexpr std::uint16_t kVersion = 2;  // the newest that is read
inline constexpr std::uint32_t kHeader = container::fourCc("DHDR");
inline constexpr std::uint32_t kTimes = container::fourCc("TIME");
inline constexpr std::uint32_t kColumns = container::fourCc("COLS");
inline constexpr std::uint32_t kParts = container::fourCc("PART");

struct Header {
  std::uint64_t vertices;     // @0   sum over pages (a vertex on a frame's grid counts once per page that uses it)
  std::uint64_t edges;        // @8
  std::uint64_t triangles;    // @16
  std::uint64_t tets;         // @24  of the hypermesh it was made from
  std::uint64_t frames;       // @32  entries of TIME
  std::uint64_t empty;        // @40  triangles dropped because their lifespan is empty (of 4 * tets)
  AffineMap index_to_world;   // @48
  Bounds4f bounds;            // @144 of the vertices; all zero if there are none
  float last_time;            // @176 frames; the one time at which lifespans are closed
  std::uint32_t columns;      // @180 entries of COLS
  std::uint64_t parts;        // @184 entries of PART; 0: the surface is one part
  std::uint64_t reserved[8];  // @192 zero
};
static_assert(sizeof(Header) == 256 && offsetof(Header, bounds) == 144 && offsetof(Header, last_time) == 176);

struct PageHeader {
  std::uint64_t vertices;     // @0
  std::uint64_t edges;        // @8
  std::uint64_t triangles;    // @16
  std::uint64_t bands;        // @24 0: one run, sorted by begin
  std::uint64_t intervals;    // @32 sum of the bands'
  std::uint64_t part;         // @40 entry of PART it belongs to; 0 without parts
  std::uint64_t reserved[2];  // @48 zero
};
static_assert(sizeof(PageHeader) == 64);

struct Edge {
  std::uint32_t a, b;  // vertices of the page, t(a) < t(b)
};
struct Lifespan {
  float begin, end;  // frames, begin < end
};
using Triangle = std::array<std::uint32_t, 3>;  // edges of the page, counter-clockwise from outside

// A run of a page's triangles. Bands follow one another and hold all triangles.
struct Band {
  std::uint64_t first, count;               // @0  triangles; count is 1 .. 2^32 - 1
  std::uint64_t first_interval, intervals;  // @16 of the index; at least 1
};
static_assert(sizeof(Band) == 32);
// The triangles of a band that can be alive in one of its intervals: first .. last - 1, counted from the band's first.
// From one interval to the next neither falls.
struct Alive {
  std::uint32_t first, last;
};
static_assert(sizeof(Alive) == 8);

// Equal intervals of a page's time. The number never falls as t rises, so a triangle alive at t lies in the intervals
// from that of its begin to that of the last float before its end.
class Intervals {
 public:
  Intervals(const Lifespan& whole, std::uint64_t count)
      : begin_(double{whole.begin}),
        scale_(static_cast<double>(count) / (double{whole.end} - double{whole.begin})),
        last_(count - 1) {}
  // The interval that holds t, the nearest one if t lies outside. A page's interval is not empty.
  std::uint64_t at(float t) const {
    const double x = (double{t} - begin_) * scale_;
    if (!(x > 0)) return 0;
    return x >= static_cast<double>(last_) ? last_ : static_cast<std::uint64_t>(x);
  }
  // The last interval in which a triangle that ends at `end` can be alive.
  std::uint64_t lastOf(float end, const Lifespan& whole) const;

 private:
  double begin_, scale_;
  std::uint64_t last_;
};

// From the first begin to the last end; {0, 0} of none.
Lifespan unionOf(std::span<const Lifespan> lives);

struct PageView {
  std::span<const Vec4f> vertices;
  std::span<const Edge> edges;
  std::span<const Lifespan> lifespans;
  std::span<const Triangle> triangles;
  std::span<const Band> bands = {};  // none: one run, sorted by begin
  std::span<const Alive> index = {};
  Lifespan interval = {};  // union of the lifespans; empty without triangles
  std::uint64_t part = 0;
  // Of band `band` the triangles among which all those alive at t stand, as first and one past the last of the page.
  // t lies in the page's interval. O(1).
  std::array<std::uint64_t, 2> aliveIn(const Band& band, float t) const {
    const Alive& run = index[band.first_interval + Intervals(interval, band.intervals).at(t)];
    return {band.first + run.first, band.first + run.last};
  }
};

// Spans over a page's bytes, proved: sizes, counts, padding, finite vertices, every index, edges forward in time,
// lifespans equal to their edges' intersection, bands and their index (or lifespans sorted by begin). O(page).
Result<PageView> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry, const std::string& file,
                              std::size_t page);

class File {
 public:
  static Result<File> open(const std::string& path);
  const container::Reader& reader() const { return *reader_; }
  const Header& header() const { return *header_; }
  std::span<const double> times() const { return times_; }
  std::span<const ColumnEntry> columns() const { return columns_; }
  std::span<const PartEntry> parts() const { return parts_; }  // empty: the surface is one part
  const paged::Pages& pages() const { return pages_; }
  // Geometry pages; they are every (1 + columns)-th page of the page table.
  std::size_t geometryPages() const { return geometryEntries().size(); }
  std::span<const paged::PageEntry> geometryEntries() const {
    return columns_.empty() ? pages_.entries() : std::span<const paged::PageEntry>(geometry_);
  }
  const paged::PageEntry& geometryEntry(std::size_t k) const { return geometryEntries()[k]; }
  // Where geometry page k stands in the page table; its columns follow.
  std::size_t tablePage(std::size_t k) const { return k * (1 + columns_.size()); }
  // The bytes of geometry page k, for validatePage() with geometryEntry(k); and column c of it: components * vertices
  // floats.
  Result<paged::PageBytes> loadGeometry(std::size_t k) const { return pages_.load(tablePage(k)); }
  Result<paged::PageBytes> loadColumn(std::size_t c, std::size_t k) const { return pages_.load(tablePage(k) + 1 + c); }
  // Sections, padding, all pages. O(file), memory of one page.
  Status verify() const;

 private:
  std::unique_ptr<container::Reader> reader_;
  const Header* header_ = nullptr;
  std::span<const double> times_;
  std::span<const ColumnEntry> columns_;
  std::span<const PartEntry> parts_;
  paged::Pages pages_;
  std::vector<paged::PageEntry> geometry_;  // a copy where columns stand between them
};

class Writer {
 public:
  // header: index_to_world, last_time; the rest is filled in at close. part_isovalues: one a part, none for one part.
  static Result<Writer> create(const std::string& path, const Header& header, std::span<const double> times,
                               paged::Codec codec, bool force, std::span<const Column> columns = {},
                               std::span<const double> part_isovalues = {});
  // `tets`, `empty`: what the page was made from, for the header's sums. An empty page is legal. page.interval is not
  // read. columns: one span per declared column, components * vertices floats.
  Status addPage(const PageView& page, std::uint64_t tets, std::uint64_t empty,
                 std::span<const std::span<const float>> columns = {});
  Status close(const std::string& provenance_json);

 private:
  std::unique_ptr<container::Writer> file_;
  std::unique_ptr<paged::PageWriter> pages_;
  Header header_{};
  std::vector<double> times_;
  std::vector<ColumnEntry> columns_;
  std::vector<PartEntry> parts_;
  Bounds4f bounds_;
};

}  // namespace tet4d::dyntri
