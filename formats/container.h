// The container of every mappable tet4d file: a 64-byte header, sections, a table of sections.
//
//   header (64 B) | sections, each 64-byte aligned (page sections 4096), zero padding between | section table (64 B
//   each)
//
// All numbers are little-endian. docs/formats/container.md suffices to write a reader; scripts/readers proves it.
//
// Reader: maps the file and proves structure — sizes, ranges, overlaps, counts, alignment, zero reserved fields, table
// and header checksums — before it hands out a span. Sections of an unknown optional kind are skipped; an unknown
// required kind is a refusal. Section and page contents are proved by verifySection() and paged::Pages::load(). Writer:
// streams to a temporary name beside the final one and renames at close; destroyed without close it leaves nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/core/result.h"

namespace tet4d::container {

// Four characters as a number whose bytes in the file read as the text.
constexpr std::uint32_t fourCc(const char (&text)[5]) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(text[0])) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(text[1])) << 8 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(text[2])) << 16 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(text[3])) << 24;
}
std::string fourCcText(std::uint32_t code);  // printable; other bytes as \xNN

inline constexpr std::size_t kAlignment = 64;        // of sections
inline constexpr std::size_t kPageAlignment = 4096;  // of page sections and of each page
inline constexpr std::uint16_t kContainerVersion = 1;

struct FileHeader {
  unsigned char magic[8];           // @0  "T4D\r\n\x1a\n\0"
  std::uint32_t endian_mark;        // @8  0x01020304
  std::uint16_t container_version;  // @12 kContainerVersion
  std::uint16_t payload_version;    // @14 of the payload named next
  std::uint32_t payload;            // @16 FourCC
  std::uint32_t section_count;      // @20
  std::uint64_t file_bytes;         // @24 whole file
  std::uint64_t table_offset;       // @32 64-byte aligned
  std::uint64_t table_xxh3;         // @40 XXH3-64 of the section table
  std::uint64_t reserved;           // @48 zero
  std::uint64_t header_xxh3;        // @56 XXH3-64 of bytes 0..55
};
static_assert(sizeof(FileHeader) == 64 && offsetof(FileHeader, header_xxh3) == 56);

// Flags of a section.
inline constexpr std::uint32_t kSectionRequired = 1u << 0;  // a reader that does not know the kind must refuse the file
inline constexpr std::uint32_t kSectionPaged = 1u << 1;     // checksums are per page (in the page table), xxh3 is zero

struct SectionEntry {
  std::uint32_t kind;          // @0  FourCC, unique in the file
  std::uint32_t flags;         // @4  kSection…
  std::uint64_t offset;        // @8  from the start of the file
  std::uint64_t bytes;         // @16 without padding; = item_bytes * item_count
  std::uint64_t item_count;    // @24
  std::uint32_t item_bytes;    // @32 at least 1
  std::uint32_t reserved0;     // @36 zero
  std::uint64_t xxh3;          // @40 XXH3-64 of the content
  std::uint64_t reserved1[2];  // @48 zero
};
static_assert(sizeof(SectionEntry) == 64 && offsetof(SectionEntry, xxh3) == 40);

inline constexpr std::uint32_t kProvenance = fourCc("PROV");  // UTF-8 JSON: program, version, options, input digests

// XXH3-64 of a range.
std::uint64_t xxh3(std::span<const std::byte> bytes);

// XXH3-64 of bytes that come in pieces: the same digest as of all of them at once.
class Xxh3Stream {
 public:
  Xxh3Stream();
  ~Xxh3Stream();
  Xxh3Stream(const Xxh3Stream&) = delete;
  Xxh3Stream& operator=(const Xxh3Stream&) = delete;
  void add(std::span<const std::byte> bytes);
  std::uint64_t digest() const;  // of what was added so far
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// A file mapped read-only. Moves; spans stay valid as long as the Reader lives. No exceptions, O(sections) to open.
class Reader {
 public:
  // Maps `path` and proves its structure. `payload` = FourCC expected, or 0 for any. `known` = the section kinds the
  // caller understands (beside PROV): a required section of another kind is a refusal.
  static Result<Reader> open(const std::string& path, std::uint32_t payload, std::uint16_t max_payload_version,
                             std::span<const std::uint32_t> known);

  const std::string& path() const { return path_; }
  const FileHeader& header() const { return header_; }
  std::span<const SectionEntry> sections() const { return sections_; }
  std::span<const std::byte> file() const { return {data_.get(), size_}; }

  // For files that stay open while others may write: puts copies in the place of the mapped sections of these kinds, so
  // that they cannot change or vanish any more. Spans stay valid. O(their bytes).
  Status ownSections(std::span<const std::uint32_t> kinds);
  // Takes what of the mapping has been read out of the process' memory: for passes over whole files, which read nothing
  // twice. Spans stay valid; what is read again comes from the system's cache. Does nothing after ownSections().
  void dropResident() const;
  // Copies bytes from the open file, past the mapping: a file that was cut off is a Fault here, and a signal where the
  // mapping is read. Thread-safe.
  Status readAt(std::uint64_t offset, std::span<std::byte> out) const;
  // What became of the file since it was opened. kReplaced: another file, or none, has its name; this one is whole.
  enum class Fate { kSame, kChanged, kReplaced };
  Fate fate() const;

  const SectionEntry* find(std::uint32_t kind) const;
  // The content of a section that must be there, as items of T (item_bytes must be sizeof(T)).
  template <class T>
  Result<std::span<const T>> items(std::uint32_t kind) const {
    auto raw = rawItems(kind, sizeof(T), alignof(T));
    if (!raw.ok()) return raw.fault();
    return std::span<const T>(reinterpret_cast<const T*>(raw.value().data()), raw.value().size() / sizeof(T));
  }
  // As items(), of exactly one item.
  template <class T>
  Result<const T*> single(std::uint32_t kind) const {
    auto all = items<T>(kind);
    if (!all.ok()) return all.fault();
    if (all.value().size() != 1) return fault(kind, "must hold exactly one item");
    return all.value().data();
  }
  // Checks the content's checksum. O(bytes).
  Status verifySection(const SectionEntry& section) const;
  // Checks that every byte that belongs to no section is zero, and all sections' checksums. O(file) except page data.
  Status verifyAll() const;
  // The provenance JSON, "{}" if there is none.
  std::string_view provenance() const;
  // A Fault of this file at a section.
  Fault fault(std::uint32_t kind, std::string what) const;

 private:
  struct Unmap {
    std::size_t size;  // of the mapping
    void operator()(const std::byte* data) const;
  };
  // The open file and what it was when it was opened.
  class Descriptor {
   public:
    Descriptor() = default;
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
      std::swap(fd_, other.fd_);
      return *this;
    }
    ~Descriptor();
    int get() const { return fd_; }

   private:
    int fd_ = -1;
  };
  struct Identity {
    std::uint64_t device = 0, inode = 0, bytes = 0;
    std::int64_t changed_s = 0, changed_ns = 0;
    bool operator==(const Identity&) const = default;
  };
  static std::optional<Identity> identify(int fd, const char* path);  // of `path` if fd < 0
  Result<std::span<const std::byte>> rawItems(std::uint32_t kind, std::size_t item_bytes, std::size_t alignment) const;

  std::string path_;
  Descriptor descriptor_;
  Identity identity_;
  bool owns_sections_ = false;
  std::unique_ptr<const std::byte[], Unmap> data_;
  std::size_t size_ = 0;
  FileHeader header_{};
  std::vector<SectionEntry> sections_;
};

// Payload and version of a file, without opening it fully (for programs that take several payloads).
Result<FileHeader> peek(const std::string& path);

// Writes a file section by section, in order. Every call returns a Fault on I/O trouble (kNoSpace when the disk is
// full).
class Writer {
 public:
  // Fails at once if `path` exists and `force` is false, or its directory cannot be written.
  static Result<Writer> create(const std::string& path, std::uint32_t payload, std::uint16_t payload_version,
                               bool force);
  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  // A whole section.
  Status add(std::uint32_t kind, std::uint32_t flags, std::size_t item_bytes, std::span<const std::byte> content);
  template <class T>
  Status add(std::uint32_t kind, std::uint32_t flags, std::span<const T> items) {
    return add(kind, flags, sizeof(T), std::as_bytes(items));
  }

  // A page section, streamed: begin, then any number of pages (each aligned to 4096), then end. Nothing else in
  // between.
  Status beginPages(std::uint32_t kind, std::uint32_t flags);
  // Appends one page; returns its offset in the file.
  Result<std::uint64_t> appendPage(std::span<const std::byte> bytes);
  // Appends to the page in hand.
  Status continuePage(std::span<const std::byte> bytes);
  Status endPages();

  // Writes the table and the header, and renames to the final name. Without it the destructor removes the temporary
  // file.
  Status close();
  std::uint64_t bytesWritten() const;
  const std::string& path() const;  // the final name

 private:
  struct State;
  explicit Writer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tet4d::container
