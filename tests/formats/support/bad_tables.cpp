#include <limits>

#include "formats/dynamic_triangles.h"
#include "formats/grid4.h"
#include "formats/hypermesh.h"
#include "tests/formats/support/bad_files.h"
#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {

std::vector<std::byte> bytesOf(const BadFile& bad) {
  Scratch scratch;
  const std::string path = scratch.path(bad.sample);
  if (!sampleNamed(bad.sample).write(path).ok()) return {};
  Image image = Image::of(path);
  bad.forge(image);
  image.seal();
  return std::move(image.bytes);
}

namespace {

constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint32_t kAlien = container::fourCc("ALIN");

// Appends room at the file's end and moves the section table there with one more entry, for the forger to fill.
container::SectionEntry& addSection(Image& image, std::size_t content_bytes) {
  const std::uint64_t old_table = image.header().table_offset, count = image.header().section_count;
  const std::uint64_t content = (image.bytes.size() + 63) / 64 * 64;
  const std::uint64_t table = content + (content_bytes + 63) / 64 * 64;
  image.bytes.resize(table + (count + 1) * 64);
  for (std::uint64_t i = 0; i < count * 64; ++i) {
    image.bytes[table + i] = image.bytes[old_table + i];
    image.bytes[old_table + i] = std::byte{0};
  }
  image.header().table_offset = table;
  image.header().section_count = static_cast<std::uint32_t>(count + 1);
  image.header().file_bytes = image.bytes.size();
  container::SectionEntry& entry = image.section(count);
  entry = {};
  entry.kind = kAlien;
  entry.offset = content;
  entry.bytes = entry.item_count = content_bytes;
  entry.item_bytes = 1;
  return entry;
}

std::vector<BadFile> badHeaders() {
  const auto header = [](std::string name, std::string what, auto forge) {
    return BadFile{name + ".t4g", "grid_u8.t4g", true, "header", std::move(what), forge};
  };
  return {
      header("header_version", "container version", [](Image& i) { i.header().container_version = 2; }),
      header("header_payload_version_0", "payload version", [](Image& i) { i.header().payload_version = 0; }),
      header("header_payload_version_9", "payload version", [](Image& i) { i.header().payload_version = 9; }),
      header("header_endian", "byte order", [](Image& i) { i.header().endian_mark = 0x04030201; }),
      header("header_reserved", "reserved", [](Image& i) { i.header().reserved = 1; }),
      header("header_file_bytes", "bytes", [](Image& i) { i.header().file_bytes += 64; }),
      header("header_table_beyond", "outside", [](Image& i) { i.header().table_offset = i.bytes.size() + 64; }),
      header("header_table_wraps", "outside", [](Image& i) { i.header().table_offset = kHuge - 63; }),
      header("header_table_misaligned", "outside", [](Image& i) { i.header().table_offset -= 8; }),
      header("header_table_is_header", "outside", [](Image& i) { i.header().table_offset = 0; }),
      header("header_count_huge", "outside", [](Image& i) { i.header().section_count = 0xffffffffu; }),
      header("header_count_one_more", "outside", [](Image& i) { i.header().section_count += 1; }),
  };
}

std::vector<BadFile> badSections() {
  const auto section = [](std::string name, std::string what, std::uint32_t kind, auto forge) {
    return BadFile{
        name + ".t4g", "grid_u8.t4g", true, "section " + container::fourCcText(kind), std::move(what), [=](Image& i) {
          forge(i, i.sectionOf(kind));
        }};
  };
  using S = container::SectionEntry;
  const std::uint32_t time = grid4::kTimes;
  std::vector<BadFile> all{
      section("section_flags", "flags", time, [](Image&, S& s) { s.flags |= 4; }),
      section("section_reserved0", "reserved", time, [](Image&, S& s) { s.reserved0 = 1; }),
      section("section_reserved1", "reserved", time, [](Image&, S& s) { s.reserved1[1] = kHuge; }),
      section("section_misaligned", "misaligned", time, [](Image&, S& s) { s.offset += 8; }),
      section("section_beyond", "outside", time, [](Image& i, S& s) { s.offset = (i.bytes.size() + 63) / 64 * 64; }),
      section("section_wraps", "outside", time, [](Image&, S& s) { s.offset = kHuge - 63; }),
      section("section_end_wraps", "outside", time,
              [](Image&, S& s) { s.bytes = kHuge - 7, s.item_count = s.bytes / 8; }),
      section("section_in_header", "outside", time, [](Image&, S& s) { s.offset = 0; }),
      section("section_item_bytes_0", "item size", time, [](Image&, S& s) { s.item_bytes = 0; }),
      section("section_item_count", "item size", time, [](Image&, S& s) { s.item_count += 1; }),
      // 2^61 + 2 items of 8 bytes are 16 bytes if the product may wrap.
      section("section_items_wrap", "item size", time,
              [](Image&, S& s) { s.item_count = (std::uint64_t{1} << 61) + s.bytes / 8; }),
      section("section_items_ragged", "item size", time, [](Image&, S& s) { s.item_bytes = 7; }),
      section("section_other_items", "items of 4", time, [](Image&, S& s) { s.item_bytes = 4, s.item_count *= 2; }),
      section("section_paged_with_sum", "checksum", paged::kPages, [](Image&, S& s) { s.xxh3 = 1; }),
      section("section_pages_not_paged", "paged", paged::kPages, [](Image&, S& s) { s.flags = 1; }),
      section("section_pages_misaligned", "misaligned", paged::kPages, [](Image&, S& s) { s.offset += 64; }),
      section("section_pages_items", "items", paged::kPages, [](Image&, S& s) { s.item_bytes = 2, s.item_count /= 2; }),
      section("section_time_missing", "missing", time, [](Image&, S& s) { s.kind = kAlien, s.flags = 0; }),
      section("section_pages_missing", "missing", paged::kPages, [](Image&, S& s) { s.kind = kAlien, s.flags = 2; }),
      section("section_table_missing", "missing", paged::kPageTable,
              [](Image&, S& s) { s.kind = kAlien, s.flags = 0; }),
      section("section_header_missing", "missing", grid4::kHeader, [](Image&, S& s) { s.kind = kAlien, s.flags = 0; }),
      section("section_header_empty", "exactly one", grid4::kHeader, [](Image&, S& s) { s.bytes = s.item_count = 0; }),
      section("section_twice", "two of them", time,
              [](Image& i, S&) { i.sectionOf(container::kProvenance).kind = grid4::kTimes; }),
  };
  const auto added = [&](std::string name, std::string place, std::string what, auto forge) {
    all.push_back({name + ".t4g", "grid_u8.t4g", true, std::move(place), std::move(what), forge});
  };
  added("section_unknown_required", "section ALIN", "unknown",
        [](Image& i) { addSection(i, 10).flags = container::kSectionRequired; });
  added("section_unknown_overlaps", "byte ", "overlap", [](Image& i) {
    const std::uint64_t time_offset = i.sectionOf(grid4::kTimes).offset;
    addSection(i, 10).offset = time_offset;
  });
  added("section_on_table", "byte ", "overlap", [](Image& i) {
    container::SectionEntry& s = addSection(i, 10);
    s.offset = i.header().table_offset;
  });
  // One byte into the next section is an overlap; touching it is not (see the odd files).
  added("section_overlaps_by_one", "byte ", "overlap", [](Image& i) {
    container::SectionEntry& s = addSection(i, 65);
    s.offset = i.header().table_offset - 64;
  });
  // Time checksummed by nobody: a section that claims to be paged.
  added("section_time_paged", "section TIME", "paged", [](Image& i) {
    container::SectionEntry& s = addSection(i, 3200);
    s.offset = (s.offset + 4095) / 4096 * 4096;
    s.bytes = 16, s.item_count = 2, s.item_bytes = 8;
    s.kind = grid4::kTimes, s.flags = 3;
    for (std::uint64_t b = 0; b < 16; ++b) i.bytes[s.offset + b] = i.bytes[i.sectionOf(grid4::kTimes).offset + b];
    i.sectionOf(grid4::kTimes).kind = kAlien;  // the first of that name: the old one
    for (std::size_t k = 0; k < i.header().section_count; ++k) {
      if (i.section(k).kind == kAlien) i.section(k).flags = 0;
    }
  });
  all.push_back({"padding_not_zero.t4g", "grid_u8.t4g", false, "byte ", "padding",
                 [](Image& i) { i.bytes[i.sectionOf(container::kProvenance).offset - 1] = std::byte{1}; }});
  all.push_back({"page_gap_not_zero.t4g", "grid_u8.t4g", false, "byte ", "padding",
                 [](Image& i) { i.bytes[i.page(1).offset - 1] = std::byte{1}; }});
  return all;
}

std::vector<BadFile> badEntries() {
  const auto entry = [](std::string name, std::string what, auto forge, std::string sample = "grid_u8.t4g",
                        std::string place = "page 1") {
    return BadFile{name + sample.substr(sample.size() - 4), sample, true, place, std::move(what), [=](Image& i) {
                     forge(i, i.page(place == "page 0" ? 0 : 1));
                   }};
  };
  using P = paged::PageEntry;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  std::vector<BadFile> all{
      entry("page_misaligned", "misaligned", [](Image&, P& p) { p.offset += 64; }),
      entry("page_beyond", "outside", [](Image&, P& p) { p.offset += 4096; }),
      entry("page_before", "outside", [](Image&, P& p) { p.offset = 0; }),
      entry("page_wraps", "outside", [](Image&, P& p) { p.offset = kHuge - 4095; }),
      entry("page_end_wraps", "outside", [](Image&, P& p) { p.bytes = p.raw_bytes = kHuge - 4095; }),
      entry("page_one_byte_beyond", "outside", [](Image&, P& p) { p.bytes = p.raw_bytes += 1; }),
      entry("page_overlaps", "overlaps", [](Image& i, P& p) { p.offset = i.page(0).offset; }),
      entry("page_order", "overlaps", [](Image& i, P& p) { std::swap(i.page(0).offset, p.offset); }),
      entry("page_empty", "size", [](Image&, P& p) { p.bytes = p.raw_bytes = 0; }),
      entry("page_raw_sizes", "raw", [](Image&, P& p) { p.raw_bytes += 1; }),
      entry("page_raw_huge", "size", [](Image&, P& p) { p.raw_bytes = kHuge; }),
      entry("page_codec", "codec", [](Image&, P& p) { p.codec = 2; }),
      entry("page_reserved", "reserved", [](Image&, P& p) { p.reserved[1] = 1; }),
      entry("page_bounds_nan", "bounds", [=](Image&, P& p) { p.bounds.min.y = kNan; }),
      entry("page_bounds_infinite", "bounds", [=](Image&, P& p) { p.bounds.max.t = kInf; }),
      entry("page_bounds_order", "bounds", [](Image&, P& p) { std::swap(p.bounds.min, p.bounds.max); }),
      entry("page_error_nan", "error", [=](Image&, P& p) { p.error_estimated = kNan; }),
      entry("page_error_infinite", "error", [=](Image&, P& p) { p.error_measured = kInf; }),
      entry("page_error_negative", "error", [](Image&, P& p) { p.error_measured = -0.5f; }),
      // 64 GiB out of a hundred bytes: refused before a byte is allocated.
      entry("page_bomb", "more than its", [](Image&, P& p) { p.codec = 1, p.raw_bytes = paged::kMaxPageBytes; }),
  };
  const auto table = [&](std::string name, auto forge) {
    all.push_back({name + ".t4g", "grid_u8.t4g", true, "section PTAB", "frame", [=](Image& i) { forge(i.page(1)); }});
  };
  table("grid_page_kind", [](P& p) { p.kind = 1; });
  table("grid_page_rank", [](P& p) { p.counts[0] = 0; });
  table("grid_page_voxels", [](P& p) { p.counts[1] += 1; });
  table("grid_page_count", [](P& p) { p.counts[2] = 1; });
  table("grid_page_box", [](P& p) { p.bounds.max.x += 1; });
  table("grid_page_time", [](P& p) { p.bounds.max.t += 1; });
  return all;
}

}  // namespace

std::vector<BadFile> badTables() {
  std::vector<BadFile> all = badHeaders();
  for (auto part : {badSections(), badEntries()}) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace tet4d::test
