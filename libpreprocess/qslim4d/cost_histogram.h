// How many edges cost how much. Private to qslim4d.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tet4d::qslim4d {

// Numbers of edges by cost: the upper half of a float, 128 bins an octave.
class CostHistogram {
 public:
  void add(float cost) {
    ++bins_[binOf(cost)];
    ++total_;
  }
  // No cost is negative, but 0 may have a sign.
  static std::uint32_t binOf(float cost) { return (std::bit_cast<std::uint32_t>(cost) & 0x7FFFFFFFu) >> 16; }
  std::uint64_t total() const { return total_; }
  // The cost that `count` of them stay at or below; infinite if there are fewer.
  float ofRank(std::uint64_t count) const {
    std::uint64_t below = 0;
    for (std::uint32_t bin = 0; bin < bins_.size(); ++bin) {
      below += bins_[bin];
      if (below >= count) return std::bit_cast<float>(bin << 16 | 0xFFFFu);
    }
    return std::numeric_limits<float>::infinity();
  }

 private:
  std::vector<std::uint64_t> bins_ = std::vector<std::uint64_t>(std::size_t{1} << 15);
  std::uint64_t total_ = 0;
};

}  // namespace tet4d::qslim4d
