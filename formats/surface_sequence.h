// surface_sequence (.t4q): a triangle mesh whose vertices move; the triangles stay. One page is one frame.
//
// Positions are f32 in index space, relative to the file's f64 map, so neither a far origin nor epoch seconds cost a
// bit. Frame k's page is Vec3f[vertices]; entry.kind = 0, counts = {k, vertices, 0, 0}, bounds = the box that holds its
// vertices, at time k. It is followed by its column pages (entry.kind = 1 + c): column c, float32. So page
// k * (1 + columns) of the table is frame k. Sections: QHDR, TIME (f64 per frame), TRIS (u32[3] a triangle), COLS
// (optional), PAGE/PTAB. docs/formats/surface_sequence.md. Ponchio & Hormann 2008, sec. 4.2: the input of the prisms.
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

namespace tet4d::surface_sequence {

inline constexpr std::uint32_t kPayload = container::fourCc("SSEQ");
inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::uint32_t kHeader = container::fourCc("QHDR");
inline constexpr std::uint32_t kTimes = container::fourCc("TIME");
inline constexpr std::uint32_t kTriangles = container::fourCc("TRIS");
inline constexpr std::uint32_t kColumns = container::fourCc("COLS");

struct Header {
  std::uint64_t vertices;      // @0   1 .. 2^32: triangles name them by u32
  std::uint64_t triangles;     // @8   items of TRIS
  std::uint64_t frames;        // @16  entries of TIME
  std::uint32_t columns;       // @24  entries of COLS
  std::uint32_t reserved0;     // @28  zero
  AffineMap index_to_world;    // @32
  Bounds4f bounds;             // @128 of the vertices of all frames
  std::uint64_t reserved1[4];  // @160 zero
};
static_assert(sizeof(Header) == 192 && offsetof(Header, bounds) == 128);

using Triangle = std::array<std::uint32_t, 3>;  // three different vertices, counter-clockwise from outside

// A frame's positions as a span over its page's bytes, proved: size and counts against `header`, finite, inside the
// entry's bounds. O(page).
Result<std::span<const Vec3f>> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry,
                                            const Header& header, const std::string& file, std::size_t page);

// A frame that came in. Moves; the span stays valid as long as it lives.
struct Frame {
  paged::PageBytes bytes;
  std::span<const Vec3f> positions;
};

// An open surface sequence. Moves; spans stay valid as long as it lives.
class File {
 public:
  // Opens and proves header, times, columns and page table; not the triangles, not the frames.
  static Result<File> open(const std::string& path);
  const container::Reader& reader() const { return *reader_; }
  const Header& header() const { return *header_; }
  std::span<const double> times() const { return times_; }
  std::span<const ColumnEntry> columns() const { return columns_; }
  const paged::Pages& pages() const { return pages_; }
  const paged::PageEntry& frameEntry(std::size_t k) const { return pages_.entries()[k * stride()]; }
  // The triangles, their checksum and every index proved. O(triangles) at every call.
  Result<std::span<const Triangle>> triangles() const;
  Result<Frame> loadFrame(std::size_t k) const;
  // Column c of frame k: components * vertices floats.
  Result<paged::PageBytes> loadColumn(std::size_t c, std::size_t k) const { return pages_.load(k * stride() + 1 + c); }
  // A digest of what the file says, the same for every codec and layout.
  Result<std::uint64_t> contentDigest() const;
  // Everything: sections, padding, triangles, all pages. O(file), memory of one page.
  Status verify() const;

 private:
  std::size_t stride() const { return 1 + columns_.size(); }
  std::unique_ptr<container::Reader> reader_;
  const Header* header_ = nullptr;
  std::span<const double> times_;
  std::span<const ColumnEntry> columns_;
  std::span<const Triangle> triangles_;
  paged::Pages pages_;
};

// Streams frames into a .t4q.
class Writer {
 public:
  // header: vertices, index_to_world; the rest is filled in. times: one a frame.
  static Result<Writer> create(const std::string& path, const Header& header, std::span<const double> times,
                               std::span<const Triangle> triangles, std::span<const Column> columns, paged::Codec codec,
                               bool force);
  // Frame by frame, in order; columns: one span per declared column, components * vertices floats.
  Status addFrame(std::span<const Vec3f> positions, std::span<const std::span<const float>> columns = {});
  Status close(const std::string& provenance_json);

 private:
  Status unfit(const std::string& what) const;
  std::unique_ptr<container::Writer> file_;
  std::unique_ptr<paged::PageWriter> pages_;
  Header header_{};
  std::vector<double> times_;
  std::vector<ColumnEntry> columns_;
  Bounds4f bounds_;
  std::size_t next_ = 0;  // frame
};

}  // namespace tet4d::surface_sequence
