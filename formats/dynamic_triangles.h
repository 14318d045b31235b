// dynamic_triangles (.t4d): what the player draws. Ponchio & Hormann 2008, sec. 7.1; flat, one level of pages.
//
// A page stands alone: it maps and draws without any other. Its bytes:
//   PageHeader (64 B) | vertices Vec4f[v] | edges Edge[e] | lifespans Lifespan[n] | triangles u32[3][n]
// each part padded with zeros to 64 bytes. entry.counts = {vertices, edges, triangles, 0}; entry.bounds.t = the union
// of the lifespans. An edge runs forward in time (vertices[a].t < vertices[b].t): edges of constant time do not exist.
// A triangle's lifespan is [begin, end) — closed at the file's last time — and equals the intersection of its edges'
// intervals. Triangles are sorted by begin, then as built. Sections: DHDR, TIME, PAGE/PTAB.
// docs/formats/dynamic_triangles.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/paged.h"

namespace tet4d::dyntri {

inline constexpr std::uint32_t kPayload = container::fourCc("DYNT");
inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::uint32_t kHeader = container::fourCc("DHDR");
inline constexpr std::uint32_t kTimes = container::fourCc("TIME");

struct Header {
  std::uint64_t vertices;      // @0   sum over pages (a vertex on a frame's grid counts once per page that uses it)
  std::uint64_t edges;         // @8
  std::uint64_t triangles;     // @16
  std::uint64_t tets;          // @24  of the hypermesh it was made from
  std::uint64_t frames;        // @32  entries of TIME
  std::uint64_t empty;         // @40  triangles dropped because their lifespan is empty (of 4 * tets)
  AffineMap index_to_world;    // @48
  Bounds4f bounds;             // @144 of the vertices; all zero if there are none
  float last_time;             // @176 frames; the one time at which lifespans are closed
  std::uint32_t reserved0;     // @180 zero
  std::uint64_t reserved1[9];  // @184 zero
};
static_assert(sizeof(Header) == 256 && offsetof(Header, bounds) == 144 && offsetof(Header, last_time) == 176);

struct PageHeader {
  std::uint64_t vertices;     // @0
  std::uint64_t edges;        // @8
  std::uint64_t triangles;    // @16
  std::uint64_t reserved[5];  // @24 zero
};
static_assert(sizeof(PageHeader) == 64);

struct Edge {
  std::uint32_t a, b;  // vertices of the page, t(a) < t(b)
};
struct Lifespan {
  float begin, end;  // frames, begin < end
};
using Triangle = std::array<std::uint32_t, 3>;  // edges of the page, counter-clockwise from outside

struct PageView {
  std::span<const Vec4f> vertices;
  std::span<const Edge> edges;
  std::span<const Lifespan> lifespans;
  std::span<const Triangle> triangles;
};

// Spans over a page's bytes, proved: sizes, counts, padding, finite vertices, every index, edges forward in time,
// lifespans equal to their edges' intersection and sorted by begin. O(page).
Result<PageView> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry, const std::string& file,
                              std::size_t page);

class File {
 public:
  static Result<File> open(const std::string& path);
  const container::Reader& reader() const { return *reader_; }
  const Header& header() const { return *header_; }
  std::span<const double> times() const { return times_; }
  const paged::Pages& pages() const { return pages_; }
  // Sections, padding, all pages. O(file), memory of one page.
  Status verify() const;

 private:
  std::unique_ptr<container::Reader> reader_;
  const Header* header_ = nullptr;
  std::span<const double> times_;
  paged::Pages pages_;
};

class Writer {
 public:
  // header: index_to_world, last_time; the rest is filled in at close.
  static Result<Writer> create(const std::string& path, const Header& header, std::span<const double> times,
                               paged::Codec codec, bool force);
  // `tets`, `empty`: what the page was made from, for the header's sums. An empty page is legal.
  Status addPage(const PageView& page, std::uint64_t tets, std::uint64_t empty);
  Status close(const std::string& provenance_json);

 private:
  std::unique_ptr<container::Writer> file_;
  std::unique_ptr<paged::PageWriter> pages_;
  Header header_{};
  std::vector<double> times_;
  Bounds4f bounds_;
};

}  // namespace tet4d::dyntri
