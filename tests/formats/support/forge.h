// Forged and odd files: an image of a file whose every field can be changed and whose checksums can then be made right,
// so that only the structural checks stand between the forger and the reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "formats/container.h"
#include "formats/paged.h"

namespace tet4d::test {

// The bytes of a well-formed file, and its structures in place.
struct Image {
  std::vector<std::byte> bytes;

  static Image of(const std::string& path);

  template <class T>
  T& at(std::uint64_t offset) {
    return *reinterpret_cast<T*>(bytes.data() + offset);
  }
  container::FileHeader& header() { return at<container::FileHeader>(0); }
  container::SectionEntry& section(std::size_t i) {
    return at<container::SectionEntry>(header().table_offset + i * sizeof(container::SectionEntry));
  }
  container::SectionEntry& sectionOf(std::uint32_t kind);
  // Item i of a section.
  template <class T>
  T& item(std::uint32_t kind, std::size_t i = 0) {
    return at<T>(sectionOf(kind).offset + i * sizeof(T));
  }
  paged::PageEntry& page(std::size_t i) { return item<paged::PageEntry>(paged::kPageTable, i); }
  std::size_t pages() { return sectionOf(paged::kPageTable).item_count; }
  // A structure inside page i as it is stored (raw pages).
  template <class T>
  T& inPage(std::size_t i, std::uint64_t offset) {
    return at<T>(page(i).offset + offset);
  }
  // Makes every checksum right again, from the inside out. Parts whose place is forged out of the file are left alone.
  void seal();
};

// What a file holds, apart from where: can be laid out in every legal way.
struct Layout {
  struct Section {
    std::uint32_t kind, flags, item_bytes;
    std::vector<std::byte> content;
  };
  container::FileHeader header{};
  std::vector<Section> sections;  // all but PAGE; PTAB's content is made when the pages are placed
  std::vector<paged::PageEntry> entries;
  std::vector<std::vector<std::byte>> pages;  // as stored

  static Layout of(const std::string& path);

  // A legal file of this content: sections and table in random order, random zero padding between them, gaps between
  // pages and behind the last, unknown optional sections, empty ones among them.
  std::vector<std::byte> oddly(std::mt19937& random) const;
};

}  // namespace tet4d::test
