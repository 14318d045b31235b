#include "tests/formats/support/forge.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/formats/support/scratch.h"

namespace tet4d::test {

using container::FileHeader;
using container::SectionEntry;

Image Image::of(const std::string& path) { return {readBytes(path)}; }

SectionEntry& Image::sectionOf(std::uint32_t kind) {
  for (std::size_t i = 0; i < header().section_count; ++i) {
    if (section(i).kind == kind) return section(i);
  }
  std::fprintf(stderr, "test set-up: no section %s\n", container::fourCcText(kind).c_str());
  std::abort();
}

void Image::seal() {
  const auto inside = [&](std::uint64_t offset, std::uint64_t count) {
    return offset <= bytes.size() && count <= bytes.size() - offset;
  };
  const auto sum = [&](std::uint64_t offset, std::uint64_t count) {
    return container::xxh3(std::span<const std::byte>(bytes).subspan(offset, count));
  };
  const std::uint64_t table_bytes = std::uint64_t{header().section_count} * sizeof(SectionEntry);
  if (inside(header().table_offset, table_bytes) && header().table_offset % 8 == 0) {
    for (std::size_t i = 0; i < header().section_count; ++i) {
      SectionEntry& s = section(i);
      if (s.kind != paged::kPageTable || !inside(s.offset, s.bytes) || s.offset % 8 != 0) continue;
      for (std::uint64_t at = s.offset; at + sizeof(paged::PageEntry) <= s.offset + s.bytes; at += 128) {
        auto& entry = this->at<paged::PageEntry>(at);
        if (inside(entry.offset, entry.bytes)) entry.xxh3 = sum(entry.offset, entry.bytes);
      }
    }
    for (std::size_t i = 0; i < header().section_count; ++i) {
      SectionEntry& s = section(i);
      if ((s.flags & container::kSectionPaged) == 0 && inside(s.offset, s.bytes)) s.xxh3 = sum(s.offset, s.bytes);
    }
    header().table_xxh3 = sum(header().table_offset, table_bytes);
  }
  header().header_xxh3 = sum(0, offsetof(FileHeader, header_xxh3));
}

Layout Layout::of(const std::string& path) {
  Image image = Image::of(path);
  Layout layout;
  layout.header = image.header();
  for (std::size_t i = 0; i < image.header().section_count; ++i) {
    const SectionEntry& s = image.section(i);
    if (s.kind == paged::kPages) continue;
    const auto begin = image.bytes.begin() + static_cast<std::ptrdiff_t>(s.offset);
    layout.sections.push_back(
        {s.kind, s.flags, s.item_bytes, std::vector(begin, begin + static_cast<std::ptrdiff_t>(s.bytes))});
  }
  for (std::size_t i = 0; i < image.pages(); ++i) {
    layout.entries.push_back(image.page(i));
    const auto begin = image.bytes.begin() + static_cast<std::ptrdiff_t>(image.page(i).offset);
    layout.pages.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(image.page(i).bytes));
  }
  return layout;
}

namespace {

void alignTo(std::vector<std::byte>& file, std::size_t alignment) {
  file.resize((file.size() + alignment - 1) / alignment * alignment);
}

template <class T>
std::span<const std::byte> bytesOf(const std::vector<T>& items) {
  return std::as_bytes(std::span(items));
}

}  // namespace

std::vector<std::byte> Layout::oddly(std::mt19937& random) const {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  std::vector<std::byte> file(sizeof(FileHeader));
  std::vector<SectionEntry> table;
  const auto append = [&](const Section& section) {
    SectionEntry entry{};
    entry.kind = section.kind;
    entry.flags = section.flags;
    entry.offset = file.size();
    entry.bytes = section.content.size();
    entry.item_bytes = section.item_bytes;
    entry.item_count = section.content.size() / section.item_bytes;
    entry.xxh3 = container::xxh3(section.content);
    file.insert(file.end(), section.content.begin(), section.content.end());
    table.push_back(entry);
  };

  // The parts in random order: sections, extra sections, the pages, and the place of the table.
  std::vector<Section> parts = sections;
  const std::size_t extras = below(4);
  for (std::size_t i = 0; i < extras; ++i) {
    const auto item_bytes = static_cast<std::uint32_t>(1 + below(200));
    std::vector<std::byte> content(item_bytes * below(4));
    for (std::byte& b : content) b = static_cast<std::byte>(random());
    parts.push_back({container::fourCc("XTR0") + (static_cast<std::uint32_t>(i) << 24), 0, item_bytes, content});
  }
  constexpr std::uint32_t kTablePart = 0;
  parts.push_back({paged::kPages, container::kSectionRequired | container::kSectionPaged, 1, {}});
  parts.push_back({kTablePart, 0, 1, {}});
  std::shuffle(parts.begin(), parts.end(), random);

  std::uint64_t table_offset = 0, page_table_offset = 0;
  std::vector<paged::PageEntry> placed = entries;
  for (const Section& part : parts) {
    alignTo(file, container::kAlignment);
    file.resize(file.size() + below(3) * container::kAlignment);
    if (part.kind == kTablePart) {
      table_offset = file.size();
      file.resize(file.size() + (parts.size() - 1) * sizeof(SectionEntry));
    } else if (part.kind == paged::kPages) {
      alignTo(file, container::kPageAlignment);
      SectionEntry entry{};
      entry.kind = part.kind;
      entry.flags = part.flags;
      entry.offset = file.size();
      entry.item_bytes = 1;
      for (std::size_t i = 0; i < pages.size(); ++i) {
        file.resize(file.size() + below(2) * container::kPageAlignment);
        alignTo(file, container::kPageAlignment);
        placed[i].offset = file.size();
        file.insert(file.end(), pages[i].begin(), pages[i].end());
      }
      file.resize(file.size() + below(3000));
      entry.bytes = entry.item_count = file.size() - entry.offset;
      table.push_back(entry);
    } else {
      if (part.kind == paged::kPageTable) page_table_offset = file.size();
      append(part);
    }
  }
  file.resize(file.size() + below(3) * 40);
  // Entries need not stand in the order of their sections.
  std::shuffle(table.begin(), table.end(), random);
  const auto put = [&](std::uint64_t offset, std::span<const std::byte> bytes) {
    std::copy(bytes.begin(), bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(offset));
  };
  put(page_table_offset, bytesOf(placed));
  put(table_offset, bytesOf(table));
  FileHeader head = header;
  head.section_count = static_cast<std::uint32_t>(table.size());
  head.table_offset = table_offset;
  head.file_bytes = file.size();
  put(0, std::as_bytes(std::span(&head, 1)));
  Image image{std::move(file)};
  image.seal();
  return std::move(image.bytes);
}

}  // namespace tet4d::test
