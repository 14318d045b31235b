// Named columns of a payload: f32 values beside its vertices, a page for each column behind each page of geometry.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tet4d {

// As it stands in a section COLS.
struct ColumnEntry {
  char name[56];             // @0  UTF-8, zero-padded, not empty
  std::uint32_t components;  // @56 1..4 float32 a vertex
  std::uint32_t reserved;    // @60 zero
};
static_assert(sizeof(ColumnEntry) == 64);

// As a writer declares it.
struct Column {
  std::string name;
  std::uint32_t components;
};

// What is wrong with a file's columns, or null.
inline const char* checkColumns(std::span<const ColumnEntry> columns) {
  std::vector<std::string_view> names;
  for (const ColumnEntry& c : columns) {
    const std::size_t length = strnlen(c.name, sizeof c.name);
    const bool padded = std::all_of(c.name + length, c.name + sizeof c.name, [](char ch) { return ch == 0; });
    if (length == 0 || length == sizeof c.name || !padded)
      return "a column's name is empty, too long or not zero-padded";
    if (c.components < 1 || c.components > 4) return "a column has impossible components";
    if (c.reserved != 0) return "reserved bytes are not zero";
    names.emplace_back(c.name, length);
  }
  std::sort(names.begin(), names.end());
  if (std::adjacent_find(names.begin(), names.end()) != names.end()) return "two columns have the same name";
  return nullptr;
}

// Columns as a file holds them; checkColumns() tells whether they may stand there.
inline std::vector<ColumnEntry> columnEntries(std::span<const Column> columns) {
  std::vector<ColumnEntry> entries(columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c].name.copy(entries[c].name, sizeof entries[c].name);
    entries[c].components = columns[c].components;
  }
  return entries;
}

}  // namespace tet4d
