// One block of a mesh, simplified on its own: a small mesh that stays in the cache, and a heap of its cheap edges.
// Private to qslim4d.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libpreprocess/qslim4d/collapse.h"
#include "libpreprocess/qslim4d/orders.h"
#include "libpreprocess/qslim4d/vertex_blocks.h"

namespace tet4d::qslim4d {

// How far a block is simplified.
struct BlockLimits {
  float cost = 0;          // no edge dearer than this, in units of which one is 1 / cost_unit
  double cost_unit = 1;    // what costs are multiplied by before they are rounded
  std::uint64_t tets = 0;  // nothing more once so many are gone
};

// Scratch space for one block after the other.
class BlockWork {
 public:
  BlockWork(const SlimMesh& whole, const Options& options);
  BlockWork(const BlockWork&) = delete;
  BlockWork& operator=(const BlockWork&) = delete;

  // Collapses edges between vertices of the block that no other block shares, the cheapest first, and writes what is
  // left back to `whole`. Several blocks may be at work on it at a time. Leaves the counts and the corners of `whole`
  // alone. The result depends on the block only.
  Stats run(SlimMesh& whole, const VertexBlocks& blocks, std::size_t block, const BlockLimits& limits);

 private:
  enum class State : std::uint8_t { kOpen, kRefused, kGone };
  // An edge no dearer than the limit.
  struct Edge {
    std::array<std::uint32_t, 2> ends;
    std::array<std::uint32_t, 2> next;  // in the lists of both ends: 2 * edge + side, or kNone
    float cost;
    State state;
  };

  void load(const SlimMesh& whole, const VertexBlocks& blocks, std::size_t block);
  void store(SlimMesh& whole, const VertexBlocks& blocks, std::size_t block) const;
  float roundedCost(double cost) const;
  void listEdges(const Ledger& ledger, float limit);
  void sortListed();
  std::uint64_t keyOf(std::uint32_t edge) const;
  void push(std::uint32_t edge);
  std::uint64_t pop();
  void collapseCheap(Ledger& ledger, float limit);
  void joinLists(std::uint32_t u, std::uint32_t v);
  void priceAgain(std::uint32_t u, const Ledger& ledger, float limit);

  Options options_;
  double cost_unit_ = 1;
  SlimMesh mesh_;
  Collapser collapser_;
  std::vector<std::uint8_t> has_moved_;  // by vertex, those that are gone among them
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_;  // by vertex: of its edges
  // Cost and number of the edges that are neither refused nor gone: as they were listed, from `next_listed_` on, and of
  // those that have been priced again, a heap. Quadrics only grow, so what an edge cost before is met before it is due:
  // it is then put in its place.
  std::vector<std::uint64_t> listed_, heap_, spare_;
  std::size_t next_listed_ = 0;
  std::vector<std::uint32_t> edge_to_;  // by vertex: of the vertex whose edges are priced again; else kNone
  std::vector<std::uint32_t> others_;
  std::vector<Collapser::Priced> priced_;
};

// Bytes that the scratch space takes at most for a block of so many vertices and tetrahedra.
std::uint64_t blockWorkBytes(std::uint64_t vertices, std::uint64_t tets);

}  // namespace tet4d::qslim4d
