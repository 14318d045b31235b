#include "libpreprocess/vpartition/partition.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libpreprocess/vpartition/random.h"
#include "libpreprocess/vpartition/voronoi.h"

namespace tet4d::vpartition {
namespace {

// Cells of a k-d tree: cut across the longest extent, in halves on one level and after a third or two thirds on the
// next, so that no plane of one level is one of the next.
class KdPartition final : public Partition {
 public:
  KdPartition(std::span<const Sample> samples, std::uint32_t cells, bool in_thirds) : in_thirds_(in_thirds) {
    std::vector<std::uint32_t> order(samples.size());
    std::iota(order.begin(), order.end(), 0U);
    build(samples, order, cells, 0);
  }
  std::uint32_t cells() const override { return cells_; }
  std::uint32_t ownerOf(const Place& at) const override {
    const Node* node = nodes_.data();
    while (node->axis != kLeaf) node = &nodes_[node->children[at[node->axis] < node->at ? 0 : 1]];
    return node->children[0];
  }

 private:
  static constexpr std::uint32_t kLeaf = 4;
  struct Node {
    std::int64_t at = 0;  // below it: the first child; else the second
    std::uint32_t axis = kLeaf;
    std::array<std::uint32_t, 2> children{};  // of a leaf: its cell
  };

  std::uint32_t build(std::span<const Sample> samples, std::span<std::uint32_t> part, std::uint32_t cells,
                      std::uint32_t depth) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    if (cells > 1 && part.size() > 1) {
      const double share = !in_thirds_ || cells < 3 ? 0.5 : depth % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
      const auto left = std::clamp<std::uint32_t>(static_cast<std::uint32_t>(std::lround(share * cells)), 1, cells - 1);
      for (const std::uint32_t axis : axesByExtent(samples, part)) {
        const std::size_t cut = divide(samples, part, axis, static_cast<double>(left) / cells);
        if (cut == 0) continue;  // all at one place along it
        const std::int64_t at = samples[part[cut]].at[axis];
        const std::uint32_t first = build(samples, part.first(cut), left, depth + 1);
        const std::uint32_t second = build(samples, part.subspan(cut), cells - left, depth + 1);
        nodes_[number] = {at, axis, {first, second}};
        return number;
      }
    }
    nodes_[number] = {0, kLeaf, {cells_++, 0}};
    return number;
  }

  static std::array<std::uint32_t, 4> axesByExtent(std::span<const Sample> samples,
                                                   std::span<const std::uint32_t> part) {
    Place low = samples[part[0]].at, high = low;
    for (const std::uint32_t i : part) {
      for (std::size_t axis = 0; axis < 4; ++axis) {
        low[axis] = std::min(low[axis], samples[i].at[axis]);
        high[axis] = std::max(high[axis], samples[i].at[axis]);
      }
    }
    std::array<std::uint32_t, 4> axes{0, 1, 2, 3};
    std::stable_sort(axes.begin(), axes.end(), [&](auto a, auto b) { return high[a] - low[a] > high[b] - low[b]; });
    return axes;
  }

  // Sorts along the axis and returns how many lie below the plane that has about `share` of the weight below it; 0 if
  // there is no plane.
  static std::size_t divide(std::span<const Sample> samples, std::span<std::uint32_t> part, std::uint32_t axis,
                            double share) {
    std::sort(part.begin(), part.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(samples[a].at[axis], a) < std::pair(samples[b].at[axis], b);
    });
    double all = 0, below = 0;
    for (const std::uint32_t i : part) all += samples[i].weight;
    std::size_t cut = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (i > 0 && samples[part[i]].at[axis] != samples[part[i - 1]].at[axis]) {
        cut = i;
        if (below >= share * all) break;
      }
      below += samples[part[i]].weight;
    }
    return cut;
  }

  bool in_thirds_;
  std::uint32_t cells_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace

std::unique_ptr<const Partition> makePartition(Kind kind, std::span<const Sample> samples, std::uint32_t cells,
                                               std::uint32_t level, std::uint64_t seed) {
  if (samples.empty()) cells = 1;
  cells = static_cast<std::uint32_t>(std::clamp<std::size_t>(cells, 1, std::max<std::size_t>(1, samples.size())));
  if (kind == Kind::kKd && !samples.empty()) return std::make_unique<KdPartition>(samples, cells, level % 2 == 0);
  if (cells == 1) return std::make_unique<Voronoi>(std::vector<Site>(1));
  std::uint64_t random = seed;
  for (std::uint32_t i = 0; i <= level; ++i) nextRandom(random);
  return std::make_unique<Voronoi>(relaxedSites(samples, cells, nextRandom(random)));
}

namespace {
constexpr std::size_t kMostSlabs = 256;
}

Sampler::Sampler(std::size_t most, double frames, std::uint64_t seed) {
  const auto slabs = static_cast<std::size_t>(std::clamp(std::ceil(frames), 1.0, static_cast<double>(kMostSlabs)));
  slabs_.resize(slabs);
  quota_ = std::max<std::size_t>(1, most / slabs);
  per_frame_ = frames > 0 ? static_cast<double>(slabs) / frames : 0;
  for (Slab& slab : slabs_) slab.random = nextRandom(seed);
}

void Sampler::add(const Sample& sample, double t) {
  const double at = std::clamp(t * per_frame_, 0.0, static_cast<double>(slabs_.size() - 1));
  Slab& slab = slabs_[static_cast<std::size_t>(at)];
  ++slab.seen;
  if (slab.kept.size() < quota_) {
    slab.kept.push_back(sample);
  } else if (const std::uint64_t place = nextRandom(slab.random, slab.seen); place < quota_) {
    slab.kept[place] = sample;
  }
}

std::vector<Sample> Sampler::take() {
  std::vector<Sample> all;
  for (Slab& slab : slabs_) {
    for (Sample& sample : slab.kept) {
      sample.weight = static_cast<double>(slab.seen) / static_cast<double>(slab.kept.size());
      all.push_back(sample);
    }
    slab.kept.clear();
  }
  return all;
}

}  // namespace tet4d::vpartition
