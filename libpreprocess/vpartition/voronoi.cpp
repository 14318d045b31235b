#include "libpreprocess/vpartition/voronoi.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libpreprocess/vpartition/random.h"

namespace tet4d::vpartition {
namespace {

constexpr std::uint32_t kLeafSites = 4;
constexpr int kRelaxations = 8, kBalances = 24;
constexpr double kHeavy = 1.5;          // a cell above this times the mean weight takes a site from the lightest
constexpr std::size_t kNeighbours = 6;  // that smooth a site's norm

std::uint64_t square(std::int64_t d) { return static_cast<std::uint64_t>(d * d); }

}  // namespace

std::uint64_t distance(const Site& site, const Place& at) {
  return kEven * (square(at[0] - site.at[0]) + square(at[1] - site.at[1]) + square(at[2] - site.at[2])) +
         site.time * square(at[3] - site.at[3]);
}

Voronoi::Voronoi(std::vector<Site> sites) : sites_(std::move(sites)), order_(sites_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.push_back({{}, {}, 0, 0, cells(), 0});
  build(0);
}

void Voronoi::build(std::uint32_t node) {
  const std::uint32_t first = nodes_[node].first, count = nodes_[node].count;
  Place low, high;
  low.fill(std::numeric_limits<std::int64_t>::max()), high.fill(std::numeric_limits<std::int64_t>::min());
  std::uint64_t time = kMostTime;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Site& site = sites_[order_[i]];
    for (std::size_t axis = 0; axis < 4; ++axis) {
      low[axis] = std::min(low[axis], site.at[axis]);
      high[axis] = std::max(high[axis], site.at[axis]);
    }
    time = std::min(time, site.time);
  }
  nodes_[node].low = low, nodes_[node].high = high, nodes_[node].time = time;
  if (count <= kLeafSites) return;
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 4; ++other)
    if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(sites_[a].at[axis], a) < std::pair(sites_[b].at[axis], b);
  });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].children = children;
  nodes_.push_back({{}, {}, 0, first, count / 2, 0});
  nodes_.push_back({{}, {}, 0, first + count / 2, count - count / 2, 0});
  build(children);
  build(children + 1);
}

std::uint64_t Voronoi::bound(const Node& node, const Place& at) const {
  std::array<std::uint64_t, 4> squares{};
  for (std::size_t axis = 0; axis < 4; ++axis)
    squares[axis] = square(std::max({std::int64_t{0}, node.low[axis] - at[axis], at[axis] - node.high[axis]}));
  return kEven * (squares[0] + squares[1] + squares[2]) + node.time * squares[3];
}

std::uint32_t Voronoi::ownerOf(const Place& at) const {
  std::uint64_t best = std::numeric_limits<std::uint64_t>::max();
  std::uint32_t owner = 0;
  struct Open {
    std::uint64_t bound;
    std::uint32_t node;
  };
  std::array<Open, 72> open;  // each level of the tree leaves one: 2^32 sites have fewer than 32 levels
  std::size_t n = 0;
  open[n++] = {bound(nodes_[0], at), 0};
  while (n > 0) {
    const Open next = open[--n];
    if (next.bound > best) continue;  // an equal bound may hide an equal distance of a smaller number
    const Node& node = nodes_[next.node];
    if (node.children == 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const std::uint32_t site = order_[i];
        const std::uint64_t d = distance(sites_[site], at);
        if (d < best || (d == best && site < owner)) best = d, owner = site;
      }
      continue;
    }
    Open near{bound(nodes_[node.children], at), node.children};
    Open far{bound(nodes_[node.children + 1], at), node.children + 1};
    if (far.bound < near.bound) std::swap(near, far);
    open[n++] = far;
    open[n++] = near;
  }
  return owner;
}

namespace {

// What the samples of a cell come to.
struct Sum {
  double weight = 0, space2 = 0, time2 = 0;
  std::array<double, 4> at{};
};

class Relaxation {
 public:
  Relaxation(std::span<const Sample> samples, std::uint32_t cells, std::uint64_t seed)
      : samples_(samples), sites_(cells), owners_(samples.size()), random_(seed) {
    draw();
  }

  std::vector<Site> run() {
    for (int i = 0; i < kRelaxations; ++i) {
      assign();
      move();
    }
    for (int i = 0; i < kBalances; ++i) {
      assign();
      if (!balance()) break;
      move();
    }
    return std::move(sites_);
  }

 private:
  // Every site begins at a sample of its own, each with a chance by its weight: one in each of as many equal shares.
  void draw() {
    double all = 0;
    for (const Sample& sample : samples_) all += sample.weight;
    double passed = 0;
    std::size_t sample = 0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      const double chance = static_cast<double>(nextRandom(random_) >> 11) * 0x1p-53;
      const double wanted = all * (static_cast<double>(i) + chance) / static_cast<double>(sites_.size());
      while (sample + 1 < samples_.size() && passed + samples_[sample].weight <= wanted)
        passed += samples_[sample++].weight;
      sites_[i].at = samples_[sample].at;
    }
  }

  void assign() {
    const Voronoi cells(sites_);
    sums_.assign(sites_.size(), {});
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sample& sample = samples_[i];
      owners_[i] = cells.ownerOf(sample.at);
      Sum& sum = sums_[owners_[i]];
      sum.weight += sample.weight;
      sum.space2 += sample.weight * sample.space2;
      sum.time2 += sample.weight * sample.time2;
      for (std::size_t axis = 0; axis < 4; ++axis) sum.at[axis] += sample.weight * static_cast<double>(sample.at[axis]);
    }
  }

  void move() {
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if (!(sums_[i].weight > 0)) continue;
      for (std::size_t axis = 0; axis < 4; ++axis)
        sites_[i].at[axis] = static_cast<std::int64_t>(sums_[i].at[axis] / sums_[i].weight);
    }
    weighTime();
  }

  // A surface has two directions in space and one along time: the mean squared length along each of the two, over that
  // along time, is what squares of time are to count.
  void weighTime() {
    std::vector<double> ratios(sites_.size(), 1);
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      const Sum& sum = sums_[i];
      if (!(sum.space2 > 0) && !(sum.time2 > 0)) continue;
      const double ratio = sum.time2 > 0 ? sum.space2 / 2 / sum.time2 : static_cast<double>(kMostTime) / kEven;
      ratios[i] = std::clamp(ratio, static_cast<double>(kLeastTime) / kEven, static_cast<double>(kMostTime) / kEven);
    }
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      const double smooth = std::sqrt(ratios[i] * meanOfNeighbours(i, ratios));
      sites_[i].time = std::clamp(static_cast<std::uint64_t>(smooth * kEven), kLeastTime, kMostTime);
    }
  }

  // Neighbours by the even norm, which is the same seen from either.
  double meanOfNeighbours(std::size_t of, const std::vector<double>& ratios) const {
    std::array<std::pair<std::uint64_t, std::size_t>, kNeighbours> nearest;
    std::size_t n = 0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if (i == of) continue;
      const std::pair entry{distance({sites_[of].at, kEven}, sites_[i].at), i};
      if (n == kNeighbours && !(entry < nearest[n - 1])) continue;
      if (n < kNeighbours) ++n;
      std::size_t at = n - 1;
      for (; at > 0 && entry < nearest[at - 1]; --at) nearest[at] = nearest[at - 1];
      nearest[at] = entry;
    }
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += ratios[nearest[k].second];
    return n > 0 ? sum / static_cast<double>(n) : ratios[of];
  }

  // Sends the site of the lightest cell into the heaviest one, if that is too heavy. True if it did.
  bool balance() {
    double all = 0;
    std::size_t heavy = 0, light = 0;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      all += sums_[i].weight;
      if (sums_[i].weight > sums_[heavy].weight) heavy = i;
      if (sums_[i].weight < sums_[light].weight) light = i;
    }
    if (heavy == light || sums_[heavy].weight * static_cast<double>(sums_.size()) <= kHeavy * all) return false;
    std::size_t farthest = samples_.size();
    std::uint64_t most = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (owners_[i] != heavy) continue;
      const std::uint64_t d = distance(sites_[heavy], samples_[i].at);
      if (d > most) most = d, farthest = i;
    }
    if (farthest == samples_.size()) return false;  // all at one place: no border can run there
    sites_[light] = {samples_[farthest].at, sites_[heavy].time};
    assign();
    return true;
  }

  std::span<const Sample> samples_;
  std::vector<Site> sites_;
  std::vector<std::uint32_t> owners_;
  std::vector<Sum> sums_;
  std::uint64_t random_;
};

}  // namespace

std::vector<Site> relaxedSites(std::span<const Sample> samples, std::uint32_t cells, std::uint64_t seed) {
  return Relaxation(samples, cells, seed).run();
}

}  // namespace tet4d::vpartition
