// The sections in front of the pages that hypermesh and dynamic_triangles have alike: header, times, columns, parts.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "formats/columns.h"
#include "formats/container.h"
#include "formats/page_layout.h"
#include "formats/parts.h"

namespace tet4d::mesh_sections {

template <class Header>
struct Sections {
  const Header* header = nullptr;
  std::span<const double> times;
  std::span<const ColumnEntry> columns;
  std::span<const PartEntry> parts;  // empty: one part
};

// The items of a section that need not be there, its checksum verified.
template <class Item>
Result<std::span<const Item>> optional(const container::Reader& reader, std::uint32_t kind) {
  if (reader.find(kind) == nullptr) return std::span<const Item>{};
  auto items = reader.items<Item>(kind);
  if (!items.ok()) return items.fault();
  if (Status s = reader.verifySection(*reader.find(kind)); !s.ok()) return s.fault();
  return items;
}

template <class Item>
Status checkCount(const container::Reader& reader, std::uint32_t kind, std::span<const Item> items,
                  std::uint64_t expected, const char* name) {
  if (items.size() == expected) return {};
  return reader.fault(
      kind, "has " + std::to_string(items.size()) + " " + name + ", the header says " + std::to_string(expected));
}

// Opens and proves the sections; Header has frames, columns and parts. Which kinds they are, `kinds` says in the order
// of Sections. check_header(header) returns what is wrong with a header, or null. Spans are the reader's.
template <class Header, class CheckHeader>
Result<Sections<Header>> open(const container::Reader& reader, const std::array<std::uint32_t, 4>& kinds,
                              const CheckHeader& check_header) {
  const auto [header_kind, times_kind, columns_kind, parts_kind] = kinds;
  Sections<Header> found;
  auto header = reader.single<Header>(header_kind);
  if (!header.ok()) return header.fault();
  auto times = reader.items<double>(times_kind);
  if (!times.ok()) return times.fault();
  auto columns = optional<ColumnEntry>(reader, columns_kind);
  if (!columns.ok()) return columns.fault();
  auto parts = optional<PartEntry>(reader, parts_kind);
  if (!parts.ok()) return parts.fault();
  for (const std::uint32_t kind : {header_kind, times_kind}) {
    if (Status status = reader.verifySection(*reader.find(kind)); !status.ok()) return status.fault();
  }
  found = {header.value(), times.value(), columns.value(), parts.value()};
  if (const char* what = check_header(*found.header)) return reader.fault(header_kind, what);
  if (Status s = page_layout::checkTimes(found.times, found.header->frames, reader.path()); !s.ok()) return s.fault();
  if (Status s = checkCount(reader, columns_kind, found.columns, found.header->columns, "columns"); !s.ok())
    return s.fault();
  if (const char* what = checkColumns(found.columns)) return reader.fault(columns_kind, what);
  if (Status s = checkCount(reader, parts_kind, found.parts, found.header->parts, "parts"); !s.ok()) return s.fault();
  if (const char* what = checkParts(found.parts)) return reader.fault(parts_kind, what);
  return found;
}

// What stands behind the `used` bytes of a column page, number `page` of the table, must be zero.
inline Status checkColumnPadding(const container::Reader& reader, std::span<const std::byte> bytes, std::uint64_t used,
                                 std::size_t page) {
  if (page_layout::allZero(bytes.subspan(used))) return {};
  return Fault{FaultCode::kBadInput, reader.path(), "page " + std::to_string(page), "padding is not zero",
               "write the file again"};
}

}  // namespace tet4d::mesh_sections
