// A small set of vertices with two flags each, emptied at no cost. Private to qslim4d.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tet4d::qslim4d {

// In a mesh of few vertices every one has a slot of its own; in a larger one they share what a hash finds.
class VertexMarks {
 public:
  // Empties the set and makes room for `count` of the mesh's `vertices`.
  void begin(std::size_t count, std::size_t vertices) {
    is_direct_ = vertices <= kMostDirect;
    const std::size_t slots = std::bit_ceil(std::max<std::size_t>(64, is_direct_ ? vertices : 4 * count));
    stamp_ += kStampStep;
    if (slots > slots_.size() || stamp_ == 0) {
      slots_.assign(std::max(slots, slots_.size()), {});
      stamp_ = kStampStep;
    }
    mask_ = slots_.size() - 1;
  }
  // The vertex's flags; a vertex that was not there has none.
  std::uint32_t flags(std::uint32_t v) const {
    const Slot& slot = slots_[slotOf(v)];
    return slot.bits >= stamp_ ? slot.bits - stamp_ : 0;
  }
  // Sets flags, 1 and 2; returns those that were set before.
  std::uint32_t add(std::uint32_t v, std::uint32_t flags) {
    Slot& slot = slots_[slotOf(v)];
    const std::uint32_t before = slot.bits >= stamp_ ? slot.bits - stamp_ : 0;
    slot = {v, stamp_ | before | flags};
    return before;
  }

 private:
  static constexpr std::size_t kMostDirect = std::size_t{1} << 14;
  static constexpr std::uint32_t kStampStep = 4;
  struct Slot {
    std::uint32_t vertex = 0, bits = 0;  // a stamp, and below it flags; no stamp is larger than the last one
  };
  std::size_t slotOf(std::uint32_t v) const {
    if (is_direct_) return v;
    std::size_t at = (v * 0x9E3779B1u >> 7) & mask_;
    while (slots_[at].bits >= stamp_ && slots_[at].vertex != v) at = (at + 1) & mask_;
    return at;
  }
  std::vector<Slot> slots_;
  std::size_t mask_ = 0;
  std::uint32_t stamp_ = 0;
  bool is_direct_ = false;
};

}  // namespace tet4d::qslim4d
