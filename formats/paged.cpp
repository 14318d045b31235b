#include "formats/paged.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>

#include "formats/page_layout.h"

#ifdef TET4D_WITH_ZSTD
#include <zstd.h>
#endif

namespace tet4d::paged {
namespace {

// An entry as files hold it.
PageEntry withStoredBounds(PageEntry entry) {
  entry.bounds = page_layout::stored(entry.bounds);
  return entry;
}

Fault badPage(const std::string& path, std::size_t i, std::string what) {
  return {FaultCode::kBadInput, path, "page " + std::to_string(i), std::move(what), "write the file again"};
}

bool finite(const Vec4f& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.t);
}

// What a page table may say of bounds: finite and ordered, an empty page's too (all zero).
bool boundsOk(const Bounds4f& b) { return finite(b.min) && finite(b.max) && !b.empty(); }

bool errorOk(float error) { return std::isfinite(error) && (error >= 0 || error == -1); }

// A zstd block is at least 4 bytes long and at most 128 KiB once decoded: no honest page claims more than that, and a
// forged one cannot make us allocate what will not come.
constexpr std::uint64_t kMaxZstdRatio = std::uint64_t{128} * 1024 / 4;

Status checkEntry(const std::string& path, std::size_t i, const PageEntry& e, std::uint64_t begin, std::uint64_t end) {
  if (e.reserved[0] != 0 || e.reserved[1] != 0) return badPage(path, i, "reserved bytes are not zero");
  if (e.offset % container::kPageAlignment != 0) return badPage(path, i, "misaligned");
  if (e.offset < begin || e.offset > end || e.bytes > end - e.offset)
    return badPage(path, i, "lies outside the page section");
  if (e.bytes == 0 || e.bytes > kMaxPageBytes || e.raw_bytes == 0 || e.raw_bytes > kMaxPageBytes) {
    return badPage(path, i, "impossible size");
  }
  if (e.codec > static_cast<std::uint32_t>(Codec::kZstd))
    return badPage(path, i, "unknown codec " + std::to_string(e.codec));
  if (e.codec == static_cast<std::uint32_t>(Codec::kRaw) && e.raw_bytes != e.bytes) {
    return badPage(path, i, "a raw page whose decoded size differs");
  }
  if (e.codec == static_cast<std::uint32_t>(Codec::kZstd) && e.raw_bytes / kMaxZstdRatio > e.bytes) {
    return badPage(path, i,
                   "claims " + std::to_string(e.raw_bytes) + " bytes, more than its " + std::to_string(e.bytes) +
                       " stored bytes can decode to");
  }
  if (!boundsOk(e.bounds)) return badPage(path, i, "bounds are not finite or not ordered");
  if (!errorOk(e.error_estimated) || !errorOk(e.error_measured)) {
    return badPage(path, i, "an error that is neither -1 nor a finite number from 0");
  }
  return {};
}

#ifdef TET4D_WITH_ZSTD
constexpr int kZstdLevel = 3;

Status checkZstd(const std::string& path, std::size_t i, std::span<const std::byte> stored, std::uint64_t raw_bytes) {
  // ZSTD_decompress would take several frames and skippable ones; a page is exactly one, complete.
  if (ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size()) {
    return badPage(path, i, "is not exactly one compressed frame");
  }
  if (ZSTD_getFrameContentSize(stored.data(), stored.size()) != raw_bytes) {
    return badPage(path, i, "the compressed frame has another size than the page table says");
  }
  return {};
}

Status decodeZstd(const std::string& path, std::size_t i, std::span<const std::byte> stored,
                  std::span<std::byte> decoded) {
  const std::size_t n = ZSTD_decompress(decoded.data(), decoded.size(), stored.data(), stored.size());
  if (ZSTD_isError(n) != 0U || n != decoded.size()) return badPage(path, i, "the compressed frame is damaged");
  return {};
}
#endif

}  // namespace

bool hasCodec(Codec codec) {
#ifdef TET4D_WITH_ZSTD
  return codec == Codec::kRaw || codec == Codec::kZstd;
#else
  return codec == Codec::kRaw;
#endif
}

Result<Pages> Pages::open(const container::Reader& reader) {
  const container::SectionEntry* section = reader.find(kPages);
  if (section == nullptr) return reader.fault(kPages, "is missing");
  if ((section->flags & container::kSectionPaged) == 0) return reader.fault(kPages, "is not marked as paged");
  if (section->item_bytes != 1) return reader.fault(kPages, "has items of more than a byte");
  auto table = reader.items<PageEntry>(kPageTable);
  if (!table.ok()) return table.fault();
  if (Status status = reader.verifySection(*reader.find(kPageTable)); !status.ok()) return status.fault();
  std::uint64_t free = section->offset;
  for (std::size_t i = 0; i < table.value().size(); ++i) {
    const PageEntry& e = table.value()[i];
    // Pages stand in the order of the table, so one pass proves that none overlap.
    if (Status status = checkEntry(reader.path(), i, e, section->offset, section->offset + section->bytes);
        !status.ok()) {
      return status.fault();
    }
    if (e.offset < free) return badPage(reader.path(), i, "overlaps the page before it");
    free = e.offset + e.bytes;
  }
  Pages pages;
  pages.reader_ = &reader;
  pages.entries_ = table.value();
  return pages;
}

Result<PageBytes> Pages::load(std::size_t i) const {
  const PageEntry& e = entries_[i];
  const auto stored = reader_->file().subspan(e.offset, e.bytes);
  // Before memory is taken for what a damaged page claims.
  if (Status status = checkStored(i, stored); !status.ok()) return status.fault();
  PageBytes page;
  page.touched_ = e.bytes;
  if (e.codec == static_cast<std::uint32_t>(Codec::kRaw)) {
    page.view_ = stored;
    return page;
  }
  try {
    page.owned_.resize((e.raw_bytes + 7) / 8);
  } catch (const std::bad_alloc&) {
    return Fault{FaultCode::kOutOfMemory, reader_->path(), "page " + std::to_string(i),
                 "no memory for " + std::to_string(e.raw_bytes) + " bytes", "use a machine with more memory"};
  }
  const auto decoded = std::as_writable_bytes(std::span(page.owned_)).first(e.raw_bytes);
  if (Status status = decodeStored(i, stored, decoded); !status.ok()) return status.fault();
  page.view_ = decoded;
  return page;
}

Status Pages::readStored(std::size_t i, std::span<std::byte> stored) const {
  Status status = reader_->readAt(entries_[i].offset, stored);
  if (status.ok()) return status;
  Fault fault = status.fault();
  fault.place = "page " + std::to_string(i) + (fault.place.empty() ? "" : ", " + fault.place);
  return fault;
}

Status Pages::decode(std::size_t i, std::span<const std::byte> stored, std::span<std::byte> decoded) const {
  if (Status status = checkStored(i, stored); !status.ok()) return status;
  return entries_[i].codec == static_cast<std::uint32_t>(Codec::kRaw) ? Status{} : decodeStored(i, stored, decoded);
}

Status Pages::checkStored(std::size_t i, std::span<const std::byte> stored) const {
  const PageEntry& e = entries_[i];
  if (container::xxh3(stored) != e.xxh3) return badPage(reader_->path(), i, "checksum mismatch");
  if (e.codec == static_cast<std::uint32_t>(Codec::kRaw)) return {};
#ifdef TET4D_WITH_ZSTD
  return checkZstd(reader_->path(), i, stored, e.raw_bytes);
#else
  return Fault{FaultCode::kNotBuilt, reader_->path(), "page " + std::to_string(i), "is compressed with zstd",
               "rebuild with TET4D_WITH_ZSTD=ON, or write the file with --page-codec raw"};
#endif
}

Status Pages::decodeStored([[maybe_unused]] std::size_t i, [[maybe_unused]] std::span<const std::byte> stored,
                           [[maybe_unused]] std::span<std::byte> decoded) const {
#ifdef TET4D_WITH_ZSTD
  return decodeZstd(reader_->path(), i, stored, decoded);
#else
  return {};  // checkStored() has refused it
#endif
}

Result<std::uint64_t> Pages::contentDigest() const {
  std::vector<std::uint64_t> digests;
  digests.reserve(entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].codec == static_cast<std::uint32_t>(Codec::kRaw)) {
      digests.push_back(entries_[i].xxh3);
      continue;
    }
    auto page = load(i);
    if (!page.ok()) return page.fault();
    digests.push_back(container::xxh3(page.value().bytes()));
  }
  return container::xxh3(std::as_bytes(std::span(digests)));
}

Status Pages::verifyPadding() const {
  const container::SectionEntry& section = *reader_->find(kPages);
  std::uint64_t end = section.offset;
  for (std::size_t i = 0; i <= entries_.size(); ++i) {
    const std::uint64_t next = i < entries_.size() ? entries_[i].offset : section.offset + section.bytes;
    const auto gap = reader_->file().subspan(end, next - end);
    if (!std::all_of(gap.begin(), gap.end(), [](std::byte b) { return b == std::byte{0}; })) {
      return Fault{FaultCode::kBadInput, reader_->path(), "byte " + std::to_string(end), "padding is not zero",
                   "the file is damaged: write it again"};
    }
    if (i < entries_.size()) end = entries_[i].offset + entries_[i].bytes;
  }
  return {};
}

Status PageWriter::begin() { return writer_->beginPages(kPages, container::kSectionRequired); }

Status PageWriter::checkSize(std::uint64_t raw_bytes) const {
  assert(raw_bytes != 0);
  if (raw_bytes <= kMaxPageBytes) return {};
  return Fault{FaultCode::kBadInput, writer_->path(), "page " + std::to_string(entries_.size()),
               std::to_string(raw_bytes) + " bytes, a page may have " + std::to_string(kMaxPageBytes),
               "cut the data into more pages"};
}

Status PageWriter::add(std::span<const std::byte> raw, PageEntry entry) {
  if (Status status = checkSize(raw.size()); !status.ok()) return status;
  std::span<const std::byte> stored = raw;
  entry = withStoredBounds(entry);
  entry.codec = static_cast<std::uint32_t>(codec_);
  if (codec_ == Codec::kZstd) {
#ifdef TET4D_WITH_ZSTD
    encoded_.resize(ZSTD_compressBound(raw.size()));
    const std::size_t n = ZSTD_compress(encoded_.data(), encoded_.size(), raw.data(), raw.size(), kZstdLevel);
    if (ZSTD_isError(n) != 0U) {
      return Fault{FaultCode::kOutOfMemory, writer_->path(), "page " + std::to_string(entries_.size()),
                   ZSTD_getErrorName(n), "write with --page-codec raw"};
    }
    stored = std::span<const std::byte>(encoded_).first(n);
#else
    return Fault{FaultCode::kNotBuilt, writer_->path(), "", "this build cannot compress pages",
                 "rebuild with TET4D_WITH_ZSTD=ON, or use --page-codec raw"};
#endif
  }
  entry.bytes = stored.size();
  entry.raw_bytes = raw.size();
  entry.xxh3 = container::xxh3(stored);
  auto offset = writer_->appendPage(stored);
  if (!offset.ok()) return offset.fault();
  entry.offset = offset.value();
  entries_.push_back(entry);
  return {};
}

Status PageWriter::addParts(std::span<const std::span<const std::byte>> parts, PageEntry entry) {
  std::uint64_t bytes = 0;
  for (const auto& part : parts) bytes += page_layout::padded(part.size());
  if (Status status = checkSize(bytes); !status.ok()) return status;
  if (codec_ == Codec::kRaw) return addRawParts(parts, entry);
  page_layout::Builder builder(bytes);
  for (const auto& part : parts) builder.add(part);
  return add(builder.bytes(), entry);
}

Status PageWriter::addRawParts(std::span<const std::span<const std::byte>> parts, PageEntry entry) {
  static constexpr std::array<std::byte, page_layout::kPartAlignment> kZeros{};
  auto offset = writer_->appendPage({});
  if (!offset.ok()) return offset.fault();
  entry = withStoredBounds(entry);
  entry.codec = static_cast<std::uint32_t>(Codec::kRaw);
  entry.offset = offset.value();
  container::Xxh3Stream digest;
  const auto put = [&](std::span<const std::byte> bytes) {
    digest.add(bytes);
    entry.bytes += bytes.size();
    return writer_->continuePage(bytes);
  };
  for (const auto& part : parts) {
    if (Status status = put(part); !status.ok()) return status;
    const std::uint64_t gap = page_layout::padded(part.size()) - part.size();
    if (Status status = put(std::span(kZeros).first(gap)); !status.ok()) return status;
  }
  entry.raw_bytes = entry.bytes;
  entry.xxh3 = digest.digest();
  entries_.push_back(entry);
  return {};
}

Status PageWriter::end() {
  if (Status status = writer_->endPages(); !status.ok()) return status;
  return writer_->add<PageEntry>(kPageTable, container::kSectionRequired, entries_);
}

}  // namespace tet4d::paged
