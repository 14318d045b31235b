#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "formats/container.h"

namespace tet4d::container {
namespace {

constexpr unsigned char kMagic[8] = {'T', '4', 'D', '\r', '\n', 0x1A, '\n', 0};
constexpr std::uint32_t kEndianMark = 0x01020304;
constexpr std::uint32_t kKnownFlags = kSectionRequired | kSectionPaged;

Fault badHeader(const std::string& path, std::string what, std::string remedy = "write the file again") {
  return {FaultCode::kBadInput, path, "header", std::move(what), std::move(remedy)};
}

Fault systemFault(const std::string& path, const char* doing) {
  const int error = errno;
  const FaultCode code = error == ENOMEM ? FaultCode::kOutOfMemory : FaultCode::kIo;
  return {code, path, "", std::string("cannot ") + doing + ": " + std::strerror(error),
          error == ENOENT ? "check the name" : "check the file's permissions and the disk"};
}

// What can be said of a header alone; `size` is the file's.
Status checkHeader(const std::string& path, const FileHeader& header, std::uint64_t size) {
  if (std::memcmp(header.magic, kMagic, 3) != 0) {
    return badHeader(path, "not a tet4d file", "tet4d-info lists what a tet4d file holds; tet4d-convert reads others");
  }
  if (std::memcmp(header.magic, kMagic, 8) != 0) {
    return badHeader(path, "the magic bytes are damaged",
                     "the file went through a text-mode transfer: copy it as binary");
  }
  if (header.endian_mark != kEndianMark) return badHeader(path, "the byte order mark is wrong");
  const auto bytes = std::as_bytes(std::span(&header, 1)).first(offsetof(FileHeader, header_xxh3));
  if (xxh3(bytes) != header.header_xxh3) return badHeader(path, "checksum mismatch");
  if (header.container_version != kContainerVersion) {
    return badHeader(path,
                     "container version " + std::to_string(header.container_version) + ", this program knows " +
                         std::to_string(kContainerVersion),
                     "use a matching version of tet4d");
  }
  if (header.reserved != 0) return badHeader(path, "reserved bytes are not zero");
  if (header.file_bytes != size) {
    return badHeader(
        path, "the header says " + std::to_string(header.file_bytes) + " bytes, the file has " + std::to_string(size),
        "the file is cut off or was appended to: copy or write it again");
  }
  if (header.table_offset % kAlignment != 0 || header.table_offset < sizeof(FileHeader) || header.table_offset > size ||
      header.section_count > (size - header.table_offset) / sizeof(SectionEntry)) {
    return badHeader(path, "the section table lies outside the file");
  }
  return {};
}

Fault badSection(const std::string& path, const SectionEntry& section, std::string what) {
  return {FaultCode::kBadInput, path, "section " + fourCcText(section.kind), std::move(what), "write the file again"};
}

Status checkSection(const std::string& path, const SectionEntry& s, std::uint64_t size) {
  if ((s.flags & ~kKnownFlags) != 0) return badSection(path, s, "unknown flags");
  if (s.reserved0 != 0 || s.reserved1[0] != 0 || s.reserved1[1] != 0) {
    return badSection(path, s, "reserved bytes are not zero");
  }
  const std::size_t alignment = (s.flags & kSectionPaged) != 0 ? kPageAlignment : kAlignment;
  if (s.offset % alignment != 0) return badSection(path, s, "misaligned");
  if (s.offset < sizeof(FileHeader) || s.offset > size || s.bytes > size - s.offset) {
    return badSection(path, s, "lies outside the file");
  }
  if (s.item_bytes == 0 || s.bytes % s.item_bytes != 0 || s.bytes / s.item_bytes != s.item_count) {
    return badSection(path, s, "its size is not item size times item count");
  }
  if ((s.flags & kSectionPaged) != 0 && s.xxh3 != 0) return badSection(path, s, "a paged section with a checksum");
  return {};
}

struct Range {
  std::uint64_t offset, bytes;
};

// All occupied ranges of the file, by offset.
std::vector<Range> occupied(const FileHeader& header, std::span<const SectionEntry> sections) {
  std::vector<Range> ranges{{0, sizeof(FileHeader)},
                            {header.table_offset, std::uint64_t{header.section_count} * sizeof(SectionEntry)}};
  for (const SectionEntry& s : sections) ranges.push_back({s.offset, s.bytes});
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) {
    return a.offset != b.offset ? a.offset < b.offset : a.bytes < b.bytes;
  });
  return ranges;
}

Status checkTable(const std::string& path, const FileHeader& header, std::span<const SectionEntry> sections) {
  std::vector<std::uint32_t> kinds;
  for (const SectionEntry& s : sections) {
    if (Status status = checkSection(path, s, header.file_bytes); !status.ok()) return status;
    kinds.push_back(s.kind);
  }
  std::sort(kinds.begin(), kinds.end());
  if (const auto twice = std::adjacent_find(kinds.begin(), kinds.end()); twice != kinds.end()) {
    return Fault{FaultCode::kBadInput, path, "section " + fourCcText(*twice), "there are two of them",
                 "write the file again"};
  }
  std::uint64_t end = 0;
  for (const Range& range : occupied(header, sections)) {
    if (range.bytes != 0 && range.offset < end) {
      return Fault{FaultCode::kBadInput, path, "byte " + std::to_string(range.offset), "sections overlap",
                   "write the file again"};
    }
    end = std::max(end, range.offset + range.bytes);
  }
  return {};
}

bool allZero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

}  // namespace

std::string fourCcText(std::uint32_t code) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) {
    const auto c = static_cast<unsigned char>(code >> shift);
    if (c >= 0x20 && c < 0x7F) {
      text += static_cast<char>(c);
    } else {
      constexpr char kHex[] = "0123456789abcdef";
      text += {'\\', 'x', kHex[c >> 4], kHex[c & 15]};
    }
  }
  return text;
}

std::uint64_t xxh3(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

struct Xxh3Stream::State {
  XXH3_state_t xxh{};
};

Xxh3Stream::Xxh3Stream() : state_(std::make_unique<State>()) { reset(); }
Xxh3Stream::~Xxh3Stream() = default;
void Xxh3Stream::add(std::span<const std::byte> bytes) { XXH3_64bits_update(&state_->xxh, bytes.data(), bytes.size()); }
std::uint64_t Xxh3Stream::digest() const { return XXH3_64bits_digest(&state_->xxh); }
void Xxh3Stream::reset() { XXH3_64bits_reset(&state_->xxh); }

void Reader::Unmap::operator()(const std::byte* data) const { munmap(const_cast<std::byte*>(data), size); }

Result<Reader> Reader::open(const std::string& path, std::uint32_t payload, std::uint16_t max_payload_version,
                            std::span<const std::uint32_t> known) {
  Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // a named pipe must not make us wait
  const int fd = descriptor.get();
  if (fd < 0) return systemFault(path, "open");
  struct stat info {};
  const bool regular = fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
  const auto size = static_cast<std::uint64_t>(std::max<off_t>(info.st_size, 0));
  if (!regular || size < sizeof(FileHeader)) {
    return badHeader(path, regular ? "the file has only " + std::to_string(size) + " bytes" : "not a regular file",
                     "containers are mapped: give a complete file");
  }
  void* mapped = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  if (mapped == MAP_FAILED) return systemFault(path, "map");

  Reader reader;
  reader.path_ = path;
  reader.size_ = size;
  reader.descriptor_ = std::move(descriptor);
  reader.identity_ = identify(fd, nullptr).value_or(Identity{});
  reader.data_ = std::unique_ptr<const std::byte[], Unmap>(static_cast<const std::byte*>(mapped), Unmap{size});
  std::memcpy(&reader.header_, mapped, sizeof(FileHeader));
  const FileHeader& header = reader.header_;
  if (Status status = checkHeader(path, header, size); !status.ok()) return status.fault();
  if (payload != 0 && header.payload != payload) {
    return badHeader(path, "holds " + fourCcText(header.payload) + ", wanted " + fourCcText(payload),
                     "tet4d-info says what a file is and which program takes it");
  }
  if (payload != 0 && (header.payload_version == 0 || header.payload_version > max_payload_version)) {
    return badHeader(path,
                     "payload version " + std::to_string(header.payload_version) + ", this program knows 1 to " +
                         std::to_string(max_payload_version),
                     "use a newer version of tet4d");
  }
  const auto table = reader.file().subspan(header.table_offset, header.section_count * sizeof(SectionEntry));
  if (xxh3(table) != header.table_xxh3) return badHeader(path, "checksum mismatch of the section table");
  reader.sections_.resize(header.section_count);
  if (!table.empty()) std::memcpy(reader.sections_.data(), table.data(), table.size());
  if (Status status = checkTable(path, header, reader.sections_); !status.ok()) return status.fault();
  for (const SectionEntry& s : reader.sections_) {
    const bool is_known = s.kind == kProvenance || std::find(known.begin(), known.end(), s.kind) != known.end();
    if (payload != 0 && (s.flags & kSectionRequired) != 0 && !is_known) {
      return badSection(path, s, "is required and unknown to this program");
    }
  }
  return reader;
}

Reader::Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

std::optional<Reader::Identity> Reader::identify(int fd, const char* path) {
  struct stat info {};
  if ((path == nullptr ? fstat(fd, &info) : ::stat(path, &info)) != 0) return std::nullopt;
  return Identity{static_cast<std::uint64_t>(info.st_dev), static_cast<std::uint64_t>(info.st_ino),
                  static_cast<std::uint64_t>(info.st_size), info.st_mtim.tv_sec, info.st_mtim.tv_nsec};
}

Status Reader::ownSections(std::span<const std::uint32_t> kinds) {
  struct Range {
    std::uint64_t begin, end;
  };
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  std::vector<Range> ranges;
  for (const SectionEntry& s : sections_) {
    const bool is_wanted = std::find(kinds.begin(), kinds.end(), s.kind) != kinds.end();
    if (!is_wanted || (s.flags & kSectionPaged) != 0 || s.bytes == 0) continue;
    // Whole pages of the machine: what they hold beside the section is the file's too, and is copied with it.
    ranges.push_back({s.offset / page * page, (s.offset + s.bytes + page - 1) / page * page});
  }
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.begin < b.begin; });
  owns_sections_ = true;
  for (auto next = ranges.begin(); next != ranges.end();) {
    // Small sections share pages: each page is mapped and read once, which is most of what opening a small file takes.
    Range whole = *next;
    while (++next != ranges.end() && next->begin <= whole.end) whole.end = std::max(whole.end, next->end);
    auto* place = const_cast<std::byte*>(data_.get()) + whole.begin;
    void* owned =
        mmap(place, whole.end - whole.begin, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    if (owned == MAP_FAILED) return systemFault(path_, "copy a section");
    if (Status status = readAt(whole.begin, {place, std::min(whole.end, size_) - whole.begin}); !status.ok())
      return status;
  }
  return {};
}

void Reader::dropResident() const {
  // Pages of the mapping are clean and the file's; copies would be lost.
  if (!owns_sections_) static_cast<void>(madvise(const_cast<std::byte*>(data_.get()), size_, MADV_DONTNEED));
}

Status Reader::readAt(std::uint64_t offset, std::span<std::byte> out) const {
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t n =
        ::pread(descriptor_.get(), out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return systemFault(path_, "read");
    if (n == 0) {
      return Fault{FaultCode::kBadInput, path_, "byte " + std::to_string(offset + done),
                   "the file ends here, and had " + std::to_string(size_) + " bytes when it was opened",
                   "the file was cut off while it was open: write it again"};
    }
    done += static_cast<std::size_t>(n);
  }
  return {};
}

Reader::Fate Reader::fate() const {
  if (identify(descriptor_.get(), nullptr) != identity_) return Fate::kChanged;
  const auto named = identify(-1, path_.c_str());
  const bool is_same = named && named->device == identity_.device && named->inode == identity_.inode;
  return is_same ? Fate::kSame : Fate::kReplaced;
}

Result<FileHeader> peek(const std::string& path) {
  auto reader = Reader::open(path, 0, 0, {});
  if (!reader.ok()) return reader.fault();
  return reader.value().header();
}

const SectionEntry* Reader::find(std::uint32_t kind) const {
  for (const SectionEntry& s : sections_) {
    if (s.kind == kind) return &s;
  }
  return nullptr;
}

Fault Reader::fault(std::uint32_t kind, std::string what) const {
  return {FaultCode::kBadInput, path_, "section " + fourCcText(kind), std::move(what), "write the file again"};
}

Result<std::span<const std::byte>> Reader::rawItems(std::uint32_t kind, std::size_t item_bytes,
                                                    std::size_t alignment) const {
  const SectionEntry* section = find(kind);
  if (section == nullptr) return fault(kind, "is missing");
  if (section->item_bytes != item_bytes) {
    return fault(
        kind, "has items of " + std::to_string(section->item_bytes) + " bytes, expected " + std::to_string(item_bytes));
  }
  if ((section->flags & kSectionPaged) != 0)
    return fault(kind, "is marked as paged, which leaves it without a checksum");
  if (alignment > kAlignment) return fault(kind, "cannot be aligned as its items need");
  return file().subspan(section->offset, section->bytes);
}

Status Reader::verifySection(const SectionEntry& section) const {
  if ((section.flags & kSectionPaged) != 0) return {};
  if (xxh3(file().subspan(section.offset, section.bytes)) == section.xxh3) return {};
  return fault(section.kind, "checksum mismatch");
}

Status Reader::verifyAll() const {
  for (const SectionEntry& s : sections_) {
    if (Status status = verifySection(s); !status.ok()) return status;
  }
  std::uint64_t end = 0;
  auto ranges = occupied(header_, sections_);
  ranges.push_back({header_.file_bytes, 0});
  for (const Range& range : ranges) {
    if (range.offset > end && !allZero(file().subspan(end, range.offset - end))) {
      return Fault{FaultCode::kBadInput, path_, "byte " + std::to_string(end), "padding is not zero",
                   "the file is damaged: write it again"};
    }
    end = std::max(end, range.offset + range.bytes);
  }
  return {};
}

std::string_view Reader::provenance() const {
  const SectionEntry* section = find(kProvenance);
  if (section == nullptr) return "{}";
  const auto bytes = file().subspan(section->offset, section->bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace tet4d::container
