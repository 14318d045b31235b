// A small set of vertices with a few flags each, emptied at no cost. Private to qslim4d.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tet4d::qslim4d {

class VertexMarks {
 public:
  // Empties the set and makes room for `vertices`.
  void begin(std::size_t vertices) {
    const std::size_t slots = std::bit_ceil(std::max<std::size_t>(64, 4 * vertices));
    if (slots > slots_.size()) slots_.assign(slots, {0, 0, 0}), stamp_ = 0;
    ++stamp_;
  }
  // The vertex's flags; a vertex that was not there has none.
  std::uint32_t& operator[](std::uint32_t v) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (v * 0x9E3779B1u >> 7) & mask;
    while (slots_[at].stamp == stamp_ && slots_[at].vertex != v) at = (at + 1) & mask;
    if (slots_[at].stamp != stamp_) slots_[at] = {v, 0, stamp_};
    return slots_[at].flags;
  }

 private:
  struct Slot {
    std::uint32_t vertex, flags;
    std::uint64_t stamp;
  };
  std::vector<Slot> slots_;
  std::uint64_t stamp_ = 0;
};

}  // namespace tet4d::qslim4d
