// Voronoi cells whose sites each have a norm of their own, and their relaxation. Private to vpartition.
//
// Lloyd 1982; Ponchio & Hormann 2008, sec. 6.3 and 6.4: where a surface moves little its tetrahedra are long in time,
// and so must be the cells there, or they are little but border.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/vpartition/partition.h"

namespace tet4d::vpartition {

// Squares of time count so many 1024ths of those of space: a factor of 8 either way.
inline constexpr std::uint64_t kEven = 1024, kLeastTime = kEven / 64, kMostTime = kEven * 64;

struct Site {
  Place at{};
  std::uint64_t time = kEven;  // kLeastTime .. kMostTime
};

// kEven times the squared distance by the site's norm. Below 2^63 for places of a lattice.
std::uint64_t distance(const Site& site, const Place& at);

class Voronoi final : public Partition {
 public:
  explicit Voronoi(std::vector<Site> sites);
  std::uint32_t cells() const override { return static_cast<std::uint32_t>(sites_.size()); }
  // The site at the least distance, of equal ones that of the smallest number. By a k-d tree.
  std::uint32_t ownerOf(const Place& at) const override;
  std::span<const Site> sites() const { return sites_; }

 private:
  struct Node {
    Place low, high;             // box of its sites
    std::uint64_t time;          // the least of theirs
    std::uint32_t first, count;  // in order_
    std::uint32_t children;      // number of the first of two; 0: a leaf
  };
  void build(std::uint32_t node);
  std::uint64_t bound(const Node& node, const Place& at) const;

  std::vector<Site> sites_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

// Sites drawn from the samples and relaxed: to the middle of their cells, with the norms that make the mean tetrahedron
// of each as long in time as it is wide, smoothed over neighbours. Cells far above the mean weight take sites from the
// smallest.
std::vector<Site> relaxedSites(std::span<const Sample> samples, std::uint32_t cells, std::uint64_t seed);

}  // namespace tet4d::vpartition
