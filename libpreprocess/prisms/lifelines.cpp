#include "libpreprocess/prisms/lifelines.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "libpreprocess/prisms/staircase.h"

namespace tet4d::prisms {
namespace {

constexpr std::size_t kBlock = 4096;  // vertices or edges a task

std::size_t blocksOf(std::size_t count) { return (count + kBlock - 1) / kBlock; }

// The frame to keep between two kept ones, h - l > 1: the roundest number, so that neighbours come to the same choice.
unsigned between(unsigned l, unsigned h) {
  return (h - 1) & ~(std::bit_floor(l ^ (h - 1)) - 1);  // h - 1 down to the highest bit in which it differs from l
}

// Frames to keep so that no stretch of one lifeline bends too far.
Kept bendsOf(const Window& window, const WorldLength& length, std::uint32_t v, Kept kept, double most_squared) {
  Kept bends = 0;
  for (Kept ahead = kept & (kept - 1); ahead != 0; ahead &= ahead - 1) {
    const auto h = static_cast<unsigned>(std::countr_zero(ahead));
    const unsigned l = keptBefore(kept, h - 1);
    for (unsigned f = l + 1; f < h; ++f) {
      if (missSquared(window, length, v, l, v, h, f) <= most_squared) continue;
      bends |= Kept{1} << between(l, h);
      break;
    }
  }
  return bends;
}

// Frames to keep at both ends of an edge so that no diagonal of the wall over it is too far off.
Kept faultsOf(const Window& window, const WorldLength& length, const Edge& edge, Kept low, Kept high,
              double most_squared) {
  Kept faults = 0;
  forEachDiagonal(low, high, [&](unsigned l, unsigned h, bool low_first) {
    for (unsigned f = l + 1; f < h; ++f) {
      const double miss =
          missSquared(window, length, low_first ? edge.low : edge.high, l, low_first ? edge.high : edge.low, h, f);
      if (miss <= most_squared) continue;
      faults |= Kept{1} << between(l, h);
      break;
    }
  });
  return faults;
}

}  // namespace

std::vector<Kept> fitLifelines(const Window& window, std::span<const Edge> edges, std::span<const std::uint8_t> used,
                               const WorldLength& length, double tolerance, outofcore::Executor& executor) {
  const double most_squared = tolerance * tolerance;
  std::vector<Kept> kept(used.size());
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] != 0) kept[v] = Kept{1} | Kept{1} << window.steps;
  if (window.steps == 1) return kept;
  // A sweep looks at lifelines and walls as they were before it, so their order is nobody's business.
  std::vector<Kept> next = kept;
  std::vector<std::uint8_t> changed(kept.size(), 1), changes(kept.size(), 0);
  std::atomic<bool> any = true;
  const auto keep = [&](std::uint32_t v, Kept frames) {
    if ((frames & ~kept[v]) == 0) return;
    std::atomic_ref(next[v]).fetch_or(frames, std::memory_order_relaxed);
    std::atomic_ref(changes[v]).store(1, std::memory_order_relaxed);
    any.store(true, std::memory_order_relaxed);
  };
  while (any) {
    any = false;
    executor.run(blocksOf(used.size()), [&](std::size_t block) {
      const std::size_t end = std::min(used.size(), (block + 1) * kBlock);
      for (auto v = static_cast<std::uint32_t>(block * kBlock); v < end; ++v)
        if (used[v] != 0 && changed[v] != 0) keep(v, bendsOf(window, length, v, kept[v], most_squared));
    });
    executor.run(blocksOf(edges.size()), [&](std::size_t block) {
      for (const auto& edge : edges.subspan(block * kBlock, std::min(kBlock, edges.size() - block * kBlock))) {
        if (changed[edge.low] == 0 && changed[edge.high] == 0) continue;
        const Kept faults = faultsOf(window, length, edge, kept[edge.low], kept[edge.high], most_squared);
        keep(edge.low, faults);
        keep(edge.high, faults);
      }
    });
    kept = next;
    changed.swap(changes);
    std::fill(changes.begin(), changes.end(), 0);
  }
  return kept;
}

}  // namespace tet4d::prisms
