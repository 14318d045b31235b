// Parts of a payload: surfaces that share a file, such as those of several isovalues. A page belongs to one part.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

namespace tet4d {

// As it stands in a section PART.
struct PartEntry {
  double isovalue;            // @0  NaN if there is none
  std::uint64_t reserved[3];  // @8  zero
};
static_assert(sizeof(PartEntry) == 32);

// What is wrong with a file's parts, or null.
inline const char* checkParts(std::span<const PartEntry> parts) {
  for (const PartEntry& part : parts) {
    for (const std::uint64_t r : part.reserved) {
      if (r != 0) return "reserved bytes are not zero";
    }
    if (std::isinf(part.isovalue)) return "a part's isovalue is infinite";
  }
  return nullptr;
}

}  // namespace tet4d
