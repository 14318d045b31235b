#include "libpreprocess/dyntri/cache_order.h"

#include <limits>

namespace tet4d::dyntri {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace

CacheOrder::CacheOrder(std::size_t edges, std::size_t longest) : of_edge_(edges) {
  next_.reserve(3 * longest);
  emitted_.reserve(longest);
  order_.reserve(longest);
  dead_ends_.reserve(3 * longest);
}

// Lists of corners, each in the order of the triangles: they are hung in from the last to the first.
void CacheOrder::link(std::span<const Triangle> triangles) {
  next_.resize(3 * triangles.size());
  emitted_.assign(triangles.size(), 0);
  for (std::size_t corner = 3 * triangles.size(); corner-- > 0;) {
    EdgeState& edge = of_edge_[triangles[corner / 3][corner % 3]];
    next_[corner] = edge.first;
    edge.first = static_cast<std::uint32_t>(corner + 1);
    ++edge.live;
  }
}

std::uint32_t CacheOrder::nextEdge(std::span<const Triangle> triangles, std::size_t fan_begin) const {
  std::uint32_t best = kNone, oldest = 0;
  for (std::size_t i = fan_begin; i < order_.size(); ++i) {
    for (const std::uint32_t e : triangles[order_[i]]) {
      const EdgeState& edge = of_edge_[e];
      if (edge.live == 0) continue;
      const std::uint32_t age = misses_ - edge.since;
      // Still there after its own triangles have brought two more vertices each: then the older, the better.
      const std::uint32_t rank = age + 2 * edge.live <= kCacheEntries ? age + 1 : 1;
      if (rank > oldest) oldest = rank, best = e;
    }
  }
  return best;
}

void CacheOrder::emitFan(std::span<const Triangle> triangles, std::uint32_t edge) {
  for (std::uint32_t corner = of_edge_[edge].first; corner != 0; corner = next_[corner - 1]) {
    const std::uint32_t i = (corner - 1) / 3;
    if (emitted_[i] != 0) continue;
    emitted_[i] = 1;
    order_.push_back(i);
    for (const std::uint32_t e : triangles[i]) {
      EdgeState& state = of_edge_[e];
      if (misses_ - state.since > kCacheEntries) state.since = misses_++;
      if (--state.live == 0) {
        state.first = 0;  // as the next run expects it
      } else {
        dead_ends_.push_back(e);
      }
    }
  }
}

std::span<const std::uint32_t> CacheOrder::order(std::span<const Triangle> triangles) {
  order_.clear();
  dead_ends_.clear();
  link(triangles);
  misses_ += kCacheEntries + 1;  // nothing of the run before is in the cache
  std::size_t scanned = 0;
  while (order_.size() < triangles.size()) {
    std::uint32_t edge = kNone;
    while (edge == kNone && !dead_ends_.empty()) {
      if (of_edge_[dead_ends_.back()].live != 0) edge = dead_ends_.back();
      dead_ends_.pop_back();
    }
    if (edge == kNone) {
      while (emitted_[scanned] != 0) ++scanned;
      edge = triangles[scanned][0];
    }
    while (edge != kNone) {
      const std::size_t fan_begin = order_.size();
      emitFan(triangles, edge);
      edge = nextEdge(triangles, fan_begin);
    }
  }
  return order_;
}

}  // namespace tet4d::dyntri
