// The columns that a user names in a list: "a,b", "all" or "none".
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/columns.h"
#include "libpreprocess/error.h"

namespace tet4d {

inline std::string columnName(const ColumnEntry& column) {
  return {column.name, strnlen(column.name, sizeof column.name)};
}

inline std::optional<std::size_t> findColumn(std::span<const ColumnEntry> columns, const std::string& name) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columnName(columns[c]) == name) return c;
  }
  return std::nullopt;
}

// What there is, for messages.
inline std::string columnsThere(std::span<const ColumnEntry> columns) {
  std::string list;
  for (const ColumnEntry& column : columns) list += (list.empty() ? "it has " : ", ") + columnName(column);
  return list.empty() ? "it has no columns" : list;
}

// Ranks of the columns named, in the order of the list; throws kUsage for a name that is not there or stands twice.
// remedy_of: what to do about a name that is not there, if there is something special to say.
inline std::vector<std::size_t> namedColumns(std::span<const ColumnEntry> columns, const std::string& list,
                                             const std::string& file,
                                             const char* (*remedy_of)(const std::string& name) = nullptr) {
  std::vector<std::size_t> named;
  if (list == "none") return named;
  if (list == "all") {
    for (std::size_t c = 0; c < columns.size(); ++c) named.push_back(c);
    return named;
  }
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string name = list.substr(begin, end - begin);
    begin = end + 1;
    const auto found = findColumn(columns, name);
    if (!found) {
      const char* remedy = remedy_of == nullptr ? nullptr : remedy_of(name);
      throw Error(FaultCode::kUsage, file, "--columns", "there is no column \"" + name + "\"; " + columnsThere(columns),
                  remedy != nullptr ? remedy : "name one of those, all or none");
    }
    if (std::count(named.begin(), named.end(), *found) != 0) {
      throw Error(FaultCode::kUsage, "", "--columns", "\"" + name + "\" is named twice", "name it once");
    }
    named.push_back(*found);
  }
  return named;
}

}  // namespace tet4d
