// Pages: the unit that is read, checked, decoded and evicted. Time slabs of a hypermesh, frames of a grid and patches
// are pages; only what lies inside one differs.
//
// A paged file has a page section (PAGE: the pages' bytes, each 4096-aligned) and a page table (PTAB: one PageEntry
// each). open() proves every entry against the page section; load() checks the checksum, decodes if needed and hands
// out bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/container.h"
#include "formats/core/vec.h"

namespace tet4d::paged {

inline constexpr std::uint32_t kPages = container::fourCc("PAGE");
inline constexpr std::uint32_t kPageTable = container::fourCc("PTAB");

enum class Codec : std::uint32_t {
  kRaw = 0,   // stored bytes are the page: mapped, not copied
  kZstd = 1,  // one zstd frame with its content size
};

struct PageEntry {
  std::uint64_t offset;       // @0  from the start of the file, 4096-aligned, inside PAGE
  std::uint64_t bytes;        // @8  as stored
  std::uint64_t raw_bytes;    // @16 after decoding; = bytes for kRaw
  std::uint64_t xxh3;         // @24 of the stored bytes
  std::uint32_t codec;        // @32 Codec
  std::uint32_t kind;         // @36 payload's: 0 = geometry or samples, 1 + c = column c
  Bounds4f bounds;            // @40 index space; t is the time interval in frames
  float error_estimated;      // @72 payload's unit; 0 = exact with respect to its input, -1 = not estimated
  float error_measured;       // @76 by an independent pass; -1 = not measured
  std::uint64_t counts[4];    // @80 payload's, so that plans need not touch pages
  std::uint64_t reserved[2];  // @112 zero
};
static_assert(sizeof(PageEntry) == 128 && offsetof(PageEntry, bounds) == 40 && offsetof(PageEntry, counts) == 80);

// Largest page a reader accepts, stored or decoded: a defence against forged sizes.
inline constexpr std::uint64_t kMaxPageBytes = std::uint64_t{1} << 36;

// One page's bytes: a view into the mapping, or an owned buffer when it was decoded. 8-byte aligned at least.
class PageBytes {
 public:
  std::span<const std::byte> bytes() const { return view_; }
  std::uint64_t touched() const { return touched_; }  // stored bytes read to get it

 private:
  friend class Pages;
  std::vector<std::uint64_t> owned_;
  std::span<const std::byte> view_;
  std::uint64_t touched_ = 0;
};

// The page table of an open file. A view: the Reader must outlive it.
class Pages {
 public:
  // Proves the table: offsets, alignment, order, no overlap, sizes, codecs, finite ordered bounds, zero reserved.
  // O(pages).
  static Result<Pages> open(const container::Reader& reader);
  std::span<const PageEntry> entries() const { return entries_; }
  std::size_t size() const { return entries_.size(); }
  // Checks and decodes page i. O(its bytes). Fault names the page. Thread-safe.
  Result<PageBytes> load(std::size_t i) const;
  // The same in two steps that never touch the mapping, for readers that stay open while others may write: the stored
  // bytes are copied into `stored` (entry.bytes long), then checked and decoded into `decoded` (entry.raw_bytes long,
  // 8-byte aligned; of a raw page they are what `stored` is, and `decoded` is not used). Thread-safe.
  Status readStored(std::size_t i, std::span<std::byte> stored) const;
  Status decode(std::size_t i, std::span<const std::byte> stored, std::span<std::byte> decoded) const;
  // A digest of the decoded pages in order, the same for every codec. Raw pages cost nothing (their checksum stands in
  // the table), others are decoded. O(compressed pages).
  Result<std::uint64_t> contentDigest() const;
  // Checks that the gaps between pages are zero. O(gaps).
  Status verifyPadding() const;

 private:
  Status checkStored(std::size_t i, std::span<const std::byte> stored) const;
  Status decodeStored(std::size_t i, std::span<const std::byte> stored, std::span<std::byte> decoded) const;

  const container::Reader* reader_ = nullptr;
  std::span<const PageEntry> entries_;
};

// Collects pages while a file is written. Usage: begin(); add() per page; end() writes PTAB.
class PageWriter {
 public:
  PageWriter(container::Writer& writer, Codec codec) : writer_(&writer), codec_(codec) {}
  Status begin();
  // Encodes and appends one page. `entry` gives kind, bounds, errors and counts; the rest is filled in.
  Status add(std::span<const std::byte> raw, PageEntry entry);
  // The same from the page's parts, each padded with zeros to page_layout::kPartAlignment. Raw pages are written from
  // where the parts stand, without a copy.
  Status addParts(std::span<const std::span<const std::byte>> parts, PageEntry entry);
  Status end();
  std::span<const PageEntry> entries() const { return entries_; }

 private:
  Status checkSize(std::uint64_t raw_bytes) const;
  Status addRawParts(std::span<const std::span<const std::byte>> parts, PageEntry entry);

  container::Writer* writer_;
  Codec codec_;
  std::vector<PageEntry> entries_;
  std::vector<std::byte> encoded_;
};

// True if this build has the codec.
bool hasCodec(Codec codec);

}  // namespace tet4d::paged
