#include "libpreprocess/qslim4d/cell_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace tet4d::qslim4d {
namespace {

constexpr int kBits = 40;  // of a place; four of them are added
constexpr std::uint32_t kDeepest = 48;

}  // namespace

FixedGrid::FixedGrid(const Bounds4f& bounds) {
  if (bounds.empty()) return;
  const std::array<double, 4> low{bounds.min.x, bounds.min.y, bounds.min.z, bounds.min.t};
  const std::array<double, 4> high{bounds.max.x, bounds.max.y, bounds.max.z, bounds.max.t};
  low_ = low;
  for (std::size_t axis = 0; axis < 4; ++axis) {
    int exponent = 0;
    std::frexp(high[axis] - low[axis], &exponent);
    scale_[axis] = high[axis] > low[axis] ? std::ldexp(1.0, kBits - exponent) : 1;
  }
}

FixedPlace FixedGrid::placeOf(const Vec4f& v) const {
  const std::array<double, 4> at{v.x, v.y, v.z, v.t};
  FixedPlace place{};
  // A product with a power of two is exact; the cast cuts off.
  for (std::size_t axis = 0; axis < 4; ++axis)
    place[axis] = static_cast<std::int64_t>((at[axis] - low_[axis]) * scale_[axis]);
  return place;
}

struct CellTree::Builder {
  CellTree& tree;
  double tets_per_sample;
  double cell_tets;
  Cuts cuts;
  std::array<double, 4> units;

  // Makes the node of `places` and returns its number.
  std::uint32_t build(std::span<FixedPlace> places, std::uint32_t depth) {
    const auto node = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_.emplace_back();
    if (static_cast<double>(places.size()) * tets_per_sample > cell_tets && depth < kDeepest) {
      for (const std::uint32_t axis : axesByExtent(places)) {
        const std::size_t left = divide(places, axis, depth);
        if (left == 0) continue;  // all at one place along it
        const std::int64_t at = places[left][axis];
        const std::uint32_t first = build(places.first(left), depth + 1);
        const std::uint32_t second = build(places.subspan(left), depth + 1);
        tree.nodes_[node] = {at, axis, {first, second}};
        return node;
      }
    }
    tree.nodes_[node] = {0, kLeaf, {tree.cells_++, 0}};
    return node;
  }

  std::array<std::uint32_t, 4> axesByExtent(std::span<const FixedPlace> places) const {
    std::array<double, 4> extent{};
    for (std::size_t axis = 0; axis < 4; ++axis) {
      std::int64_t low = std::numeric_limits<std::int64_t>::max(), high = std::numeric_limits<std::int64_t>::min();
      for (const FixedPlace& place : places) low = std::min(low, place[axis]), high = std::max(high, place[axis]);
      extent[axis] = static_cast<double>(high - low) * units[axis];
    }
    std::array<std::uint32_t, 4> axes{0, 1, 2, 3};
    std::stable_sort(axes.begin(), axes.end(), [&](auto a, auto b) { return extent[a] > extent[b]; });
    return axes;
  }

  // Orders the places into those below a plane, whose number it returns, and those that are not, the least of them in
  // front. 0: there is no such plane.
  std::size_t divide(std::span<FixedPlace> places, std::uint32_t axis, std::uint32_t depth) const {
    const auto below = [axis](const FixedPlace& a, const FixedPlace& b) { return a[axis] < b[axis]; };
    const std::size_t n = places.size();
    const std::size_t rank = cuts == Cuts::kHalves ? n / 2 : depth % 2 == 0 ? n / 3 : n - n / 3;
    const auto middle = places.begin() + static_cast<std::ptrdiff_t>(std::min(rank, n - 1));
    std::nth_element(places.begin(), middle, places.end(), below);
    const FixedPlace at = *middle;
    auto edge = std::partition(places.begin(), places.end(), [&](const FixedPlace& p) { return below(p, at); });
    if (edge == places.begin())  // many at the least place: they are the first side
      edge = std::partition(places.begin(), places.end(), [&](const FixedPlace& p) { return !below(at, p); });
    if (edge == places.begin() || edge == places.end()) return 0;
    std::iter_swap(edge, std::min_element(edge, places.end(), below));
    return static_cast<std::size_t>(edge - places.begin());
  }
};

CellTree::CellTree(std::vector<FixedPlace> sample, std::uint64_t tets, std::uint64_t cell_tets, Cuts cuts,
                   const std::array<double, 4>& units) {
  const double share = sample.empty() ? 0 : static_cast<double>(tets) / static_cast<double>(sample.size());
  Builder{*this, share, static_cast<double>(cell_tets), cuts, units}.build(sample, 0);
}

std::uint32_t CellTree::cellOf(const FixedPlace& sum) const {
  const Node* node = nodes_.data();
  while (node->axis != kLeaf) node = &nodes_[node->children[sum[node->axis] < node->at ? 0 : 1]];
  return node->children[0];
}

}  // namespace tet4d::qslim4d
