// How a part of a mesh is cut into pages, from its tetrahedra in order. Private to qslim4d.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "formats/core/vec.h"
#include "libpreprocess/qslim4d/packed_mesh.h"

namespace tet4d::qslim4d {

// A tetrahedron by the numbers of its vertices.
using Numbers = std::array<std::uint64_t, 4>;

// Vertices begin .. end - 1 of a part, and what its tetrahedra reach.
struct Page {
  std::size_t part = 0;
  std::uint64_t begin = 0, end = 0;
  std::uint64_t first_tet = 0, tets = 0;
  std::uint64_t first = 0;  // number of its first vertex in the file
  Bounds4f bounds;
};

// Cuts a part into pages as pack() and writeMeshes() do, from its tetrahedra in order.
class PagePlan {
 public:
  PagePlan(std::size_t part, std::span<const Vec4f> vertices) : part_(part), vertices_(vertices) {}

  // Tetrahedra ascend by `first`, their least vertex.
  void add(std::uint64_t first, const Numbers& tet) {
    if (first != vertex_) closeVertex(first);
    Reach one{1, {}};
    for (const std::uint64_t v : tet) one.bounds.add(vertices_[v]);
    own_.add(one);
  }

  std::vector<Page> finish() {
    closeVertex(vertices_.size());
    while (begin_ < vertices_.size()) closeAt(std::min<std::uint64_t>(vertices_.size(), begin_ + kMostPageItems));
    return std::move(pages_);
  }

 private:
  // Tetrahedra that come one after the other, and what they reach.
  struct Reach {
    std::uint64_t tets = 0;
    Bounds4f bounds;
    void add(const Reach& other) {
      tets += other.tets;
      bounds.add(other.bounds);
    }
  };

  // All tetrahedra of vertex_ are known, those in front of `next` have none.
  void closeVertex(std::uint64_t next) {
    // The page may not take them, or it would end on its way here.
    if (page_.tets + own_.tets > kMostPageItems && vertex_ > begin_) closeAt(vertex_);
    page_.add(own_);
    own_ = {};
    vertex_ = next;
    if (next == vertices_.size()) return;
    // What comes first on the way to `next`: as many vertices as a page may have, or the end of a frame.
    for (;;) {
      if (const std::uint64_t full = begin_ + kMostPageItems; full <= std::min(next, end_)) {
        closeAt(full);
      } else if (end_ <= next) {
        if (end_ > begin_ && page_.tets >= kLeastPageTets) closeAt(end_);
        endFrame();
      } else {
        return;
      }
    }
  }

  void endFrame() {
    const float frame = std::floor(vertices_[end_].t);
    while (end_ < vertices_.size() && std::floor(vertices_[end_].t) == frame) ++end_;
  }

  void closeAt(std::uint64_t end) {
    for (std::uint64_t v = begin_; v < end && page_.tets == 0; ++v) page_.bounds.add(vertices_[v]);
    pages_.push_back({part_, begin_, end, tets_, page_.tets, 0, page_.bounds});
    tets_ += page_.tets;
    begin_ = end;
    page_ = {};
  }

  std::size_t part_;
  std::span<const Vec4f> vertices_;
  std::vector<Page> pages_;
  std::uint64_t begin_ = 0, end_ = 0;  // of the page; of the frame that is read
  std::uint64_t vertex_ = 0, tets_ = 0;
  Reach page_, own_;  // of the page without vertex_; of vertex_
};

}  // namespace tet4d::qslim4d
