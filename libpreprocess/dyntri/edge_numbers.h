// Numbers for the edges of a page, 0, 1, … in the order in which they first appear.
//
// Edges hang in chains at their earlier ends: tetrahedra that follow one another share vertices, so the chains they
// walk are in cache. A chain ends after kLongest; the further edges of such a vertex go to a hash table, so no mesh
// makes the search slow. The numbers depend on the order of the calls alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "formats/dynamic_triangles.h"

namespace tet4d::dyntri {

class EdgeNumbers {
 public:
  explicit EdgeNumbers(std::size_t vertices) : head_(vertices, kNone), slots_(kFirstSlots, kNone) {}

  // The number of edge (a, b), its earlier end first. Amortised O(1).
  std::uint32_t number(std::uint32_t a, std::uint32_t b) {
    std::size_t steps = 0;
    for (std::uint32_t e = head_[a]; e != kNone; e = next_[e], ++steps) {
      if (edges_[e].b == b) return e;
    }
    if (steps >= kLongest) return numberInTable(a, b);
    const std::uint32_t e = add(a, b);
    next_[e] = head_[a];
    head_[a] = e;
    return e;
  }
  // By number.
  const std::vector<Edge>& edges() const { return edges_; }

  // Bytes held at most for so many edges of so many vertices, while the tables grow too.
  static std::uint64_t boundMemory(std::uint64_t edges, std::uint64_t vertices) {
    return vertices * sizeof(std::uint32_t) + edges * (3 * (sizeof(Edge) + 4) + 6 * 4) + kFirstSlots * 4;
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::size_t kLongest = 24, kFirstSlots = 64;

  std::uint32_t add(std::uint32_t a, std::uint32_t b) {
    edges_.push_back({a, b});
    next_.push_back(kNone);
    return static_cast<std::uint32_t>(edges_.size() - 1);
  }
  std::size_t place(const Edge& edge) const {
    const std::uint64_t key = std::uint64_t{edge.a} << 32 | edge.b;
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (key ^ key >> 29) * 0x9E3779B97F4A7C15U >> 20 & mask;
    while (slots_[at] != kNone && (edges_[slots_[at]].a != edge.a || edges_[slots_[at]].b != edge.b))
      at = (at + 1) & mask;
    return at;
  }
  std::uint32_t numberInTable(std::uint32_t a, std::uint32_t b) {
    std::size_t at = place({a, b});
    if (slots_[at] != kNone) return slots_[at];
    if (2 * (used_ + 1) > slots_.size()) {
      std::vector<std::uint32_t> old(2 * slots_.size(), kNone);
      old.swap(slots_);
      for (const std::uint32_t e : old) {
        if (e != kNone) slots_[place(edges_[e])] = e;
      }
      at = place({a, b});
    }
    ++used_;
    return slots_[at] = add(a, b);
  }

  std::vector<std::uint32_t> head_;   // of the vertices: the youngest edge of the chain
  std::vector<Edge> edges_;           // by number
  std::vector<std::uint32_t> next_;   // of the edges: the next of its chain
  std::vector<std::uint32_t> slots_;  // open addressing, at most half full: edges of long chains
  std::size_t used_ = 0;
};

}  // namespace tet4d::dyntri
