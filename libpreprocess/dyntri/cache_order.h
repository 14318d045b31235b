// The order of triangles within a bucket, for caches of slice vertices: tipsify.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"

namespace tet4d::dyntri {

// Entries of the first-in-first-out cache that the order is made for; larger ones gain too.
inline constexpr std::uint32_t kCacheEntries = 16;

// Orders runs of triangles so that few of their slice vertices, which are edges, miss a cache. Sander, Nehab &
// Barczak, "Fast triangle reordering for vertex locality and reduced overdraw", SIGGRAPH 2007: all triangles at one
// vertex in turn, then those at the vertex that will stay in the cache and has been there longest.
class CacheOrder {
 public:
  // For runs of at most `longest` triangles, made of edges 0 … edges - 1.
  CacheOrder(std::size_t edges, std::size_t longest);

  // Held, of an edge and of a triangle of the longest run.
  static constexpr std::size_t kBytesAnEdge = 12, kBytesATriangle = 3 * 4 + 1 + 4 + 3 * 4;

  // The numbers 0 … n - 1 of `triangles` in their new order; valid until the next call. Depends on the run alone,
  // however the edges are numbered. O(n).
  std::span<const std::uint32_t> order(std::span<const Triangle> triangles);

 private:
  struct EdgeState {
    std::uint32_t first = 0;  // corner + 1 of its list of corners, 0: none
    std::uint32_t live = 0;   // triangles not yet in the order
    std::uint32_t since = 0;  // misses when it came into the cache
  };
  void link(std::span<const Triangle> triangles);
  void emitFan(std::span<const Triangle> triangles, std::uint32_t edge);
  std::uint32_t nextEdge(std::span<const Triangle> triangles, std::size_t fan_begin) const;

  std::vector<EdgeState> of_edge_;   // of the page
  std::vector<std::uint32_t> next_;  // of each corner of the run: the next corner + 1 at its edge
  std::vector<std::uint8_t> emitted_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> dead_ends_;
  std::uint32_t misses_ = kCacheEntries + 1;
};

}  // namespace tet4d::dyntri
