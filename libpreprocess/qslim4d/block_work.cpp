#include "libpreprocess/qslim4d/block_work.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <numeric>
#include <utility>

namespace tet4d::qslim4d {
namespace {

// Room for merged stars, as a share of the block's corners.
constexpr std::size_t kRoomShare = 2;

}  // namespace

BlockWork::BlockWork(const SlimMesh& whole, const Options& options)
    : options_(options), collapser_(mesh_, options.rules) {
  mesh_.space = whole.space;
  mesh_.domain = whole.domain;
  mesh_.columns = whole.columns.withoutVertices();
}

void BlockWork::load(const SlimMesh& whole, const VertexBlocks& blocks, std::size_t block) {
  const auto vertices = blocks.verticesOf(block);
  const std::uint32_t begin = blocks.begins[block];
  const std::size_t count = vertices.size();
  mesh_.positions.resize(count), mesh_.quadrics.resize(count), mesh_.walls.resize(count);
  mesh_.is_boundary.resize(count), mesh_.stars.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t v = vertices[i];
    mesh_.positions[i] = whole.positions[v];
    mesh_.quadrics[i] = whole.quadrics[v];
    mesh_.walls[i] = whole.walls[v];
    mesh_.is_boundary[i] = whole.is_boundary[v];
    if (blocks.is_shared[begin + i] != 0) mesh_.is_boundary[i] |= kLocked;
  }
  whole.columns.copyTo(mesh_.columns, vertices);
  mesh_.tets.clear();
  for (const std::uint32_t t : blocks.tetsOf(block)) {
    hypermesh::Tet& tet = mesh_.tets.emplace_back(whole.tets[t]);
    for (std::uint32_t& v : tet) v = blocks.places[v] - begin;
  }
  mesh_.corners.resize(4 * mesh_.tets.size() + 4 * mesh_.tets.size() / kRoomShare);
  tidy(mesh_);
  has_moved_.assign(count, 0);
  first_.assign(count, kNone);
  edge_to_.assign(count, kNone);
  edges_.clear(), listed_.clear(), heap_.clear();
}

void BlockWork::store(SlimMesh& whole, const VertexBlocks& blocks, std::size_t block) const {
  const auto vertices = blocks.verticesOf(block);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    if (has_moved_[i] == 0) continue;
    const std::uint32_t v = vertices[i];
    if (!mesh_.isUsed(i)) {
      whole.stars[v] = {};
      continue;
    }
    whole.positions[v] = mesh_.positions[i];
    whole.quadrics[v] = mesh_.quadrics[i];
    whole.walls[v] = mesh_.walls[i];
    whole.is_boundary[v] = mesh_.is_boundary[i];
    mesh_.columns.copyVertex(i, whole.columns, v);
  }
  auto to = blocks.tetsOf(block).begin();
  for (const hypermesh::Tet& tet : mesh_.tets) {
    if (tet[0] == kNone) continue;
    hypermesh::Tet& named = whole.tets[*to++];
    for (std::size_t c = 0; c < 4; ++c) named[c] = vertices[tet[c]];
  }
  for (; to != blocks.tetsOf(block).end(); ++to) whole.tets[*to][0] = kNone;
}

float BlockWork::roundedCost(double cost) const {
  return static_cast<float>(cost * cost_unit_) + 0.0F;  // not -0, whose bits come last
}

std::uint64_t BlockWork::keyOf(std::uint32_t edge) const {
  return std::uint64_t{std::bit_cast<std::uint32_t>(edges_[edge].cost)} << 32 | edge;
}

void BlockWork::push(std::uint32_t edge) {
  heap_.push_back(keyOf(edge));
  std::push_heap(heap_.begin(), heap_.end(), std::greater());
}

std::uint64_t BlockWork::pop() {
  if (heap_.empty() || (next_listed_ < listed_.size() && listed_[next_listed_] < heap_.front()))
    return listed_[next_listed_++];
  std::pop_heap(heap_.begin(), heap_.end(), std::greater());
  const std::uint64_t key = heap_.back();
  heap_.pop_back();
  return key;
}

void BlockWork::listEdges(const Ledger& ledger, float limit) {
  for (std::uint32_t u = 0; u < mesh_.positions.size(); ++u) {
    if ((mesh_.is_boundary[u] & kLocked) != 0) continue;
    others_.clear(), priced_.clear();
    for (const std::uint32_t w : collapser_.neighbours(u))
      if (w > u) others_.push_back(w);
    collapser_.price(u, others_, priced_);
    for (const auto& [w, exact_cost, error] : priced_) {
      const float cost = roundedCost(exact_cost);
      if (!(cost <= limit) || !ledger.isAllowed(error)) continue;
      const auto edge = static_cast<std::uint32_t>(edges_.size());
      edges_.push_back({{u, w}, {first_[u], first_[w]}, cost, State::kOpen});
      first_[u] = 2 * edge, first_[w] = 2 * edge + 1;
      listed_.push_back(keyOf(edge));
    }
  }
  sortListed();
}

// By cost, those of one cost as they are: digit by digit from the last one.
void BlockWork::sortListed() {
  constexpr unsigned kDigit = 11;
  constexpr std::uint64_t kMask = (1U << kDigit) - 1;
  spare_.resize(listed_.size());
  for (unsigned shift = 32; shift < 64; shift += kDigit) {
    std::array<std::uint32_t, kMask + 1> begins{};
    for (const std::uint64_t key : listed_) ++begins[key >> shift & kMask];
    std::exclusive_scan(begins.begin(), begins.end(), begins.begin(), 0U);
    for (const std::uint64_t key : listed_) spare_[begins[key >> shift & kMask]++] = key;
    std::swap(listed_, spare_);
  }
  next_listed_ = 0;
}

// v has become u: the edges of both are u's, of two to one vertex one is kept.
void BlockWork::joinLists(std::uint32_t u, std::uint32_t v) {
  const std::array<std::uint32_t, 2> firsts{first_[u], first_[v]};
  first_[v] = kNone;
  others_.clear();
  std::uint32_t* tail = &first_[u];
  for (const std::uint32_t first : firsts) {
    for (std::uint32_t at = first, next = 0; at != kNone; at = next) {
      Edge& edge = edges_[at / 2];
      const std::uint32_t side = at % 2, w = edge.ends[1 - side];
      next = edge.next[side];
      if (edge.state == State::kGone) continue;
      if (edge_to_[w] != kNone) {
        edge.state = State::kGone;
        continue;
      }
      edge_to_[w] = at / 2;
      others_.push_back(w);
      edge.ends[side] = u;
      *tail = at;
      tail = &edge.next[side];
    }
  }
  *tail = kNone;
}

// The edges that joinLists() has found; those that were refused may be allowed now.
void BlockWork::priceAgain(std::uint32_t u, const Ledger& ledger, float limit) {
  priced_.clear();
  collapser_.price(u, others_, priced_);
  for (const auto& [w, exact_cost, error] : priced_) {
    const std::uint32_t number = std::exchange(edge_to_[w], kNone);
    Edge& edge = edges_[number];
    edge.cost = roundedCost(exact_cost);
    if (!(edge.cost <= limit) || !ledger.isAllowed(error)) {
      edge.state = State::kGone;
    } else if (edge.state == State::kRefused) {
      edge.state = State::kOpen;
      push(number);
    }
  }
  // What the walls forbid now has no price.
  for (const std::uint32_t w : others_)
    if (const std::uint32_t number = std::exchange(edge_to_[w], kNone); number != kNone)
      edges_[number].state = State::kGone;
}

void BlockWork::collapseCheap(Ledger& ledger, float limit) {
  while (!ledger.isDone() && (!heap_.empty() || next_listed_ < listed_.size())) {
    const std::uint64_t key = pop();
    const auto number = static_cast<std::uint32_t>(key);
    Edge& edge = edges_[number];
    if (edge.state == State::kGone) continue;
    if (key < keyOf(number)) {  // dearer than it was
      push(number);
      continue;
    }
    const std::uint32_t u = std::min(edge.ends[0], edge.ends[1]), v = std::max(edge.ends[0], edge.ends[1]);
    Placement placement;
    if (!collapser_.evaluate(u, v, placement) || !ledger.isAllowed(placement)) {
      edge.state = State::kGone;
      continue;
    }
    makeRoom(mesh_, std::uint64_t{mesh_.stars[u].size} + mesh_.stars[v].size);
    const Verdict verdict = collapser_.judge(u, v, placement.at);
    ledger.judged(verdict);
    if (verdict != Verdict::kAllowed) {
      edge.state = State::kRefused;
      continue;
    }
    edge.state = State::kGone;
    ledger.collapsed(collapser_.merge(u, v, placement.at), placement);
    has_moved_[u] = has_moved_[v] = 1;
    joinLists(u, v);
    priceAgain(u, ledger, limit);
  }
}

Stats BlockWork::run(SlimMesh& whole, const VertexBlocks& blocks, std::size_t block, const BlockLimits& limits) {
  load(whole, blocks, block);
  cost_unit_ = limits.cost_unit;
  options_.target_tets = mesh_.live_tets - std::min(mesh_.live_tets, limits.tets);
  outofcore::Progress nothing_told;
  Ledger ledger(mesh_, options_, nothing_told);
  if (!ledger.isDone()) {
    listEdges(ledger, limits.cost);
    collapseCheap(ledger, limits.cost);
    if (ledger.stats.collapses > 0) store(whole, blocks, block);
  }
  return ledger.stats;
}

std::uint64_t blockWorkBytes(std::uint64_t vertices, std::uint64_t tets) {
  // Edges and the heap at most twice as long as it need be.
  return 2 * (vertices + tets) * (sizeof(std::uint32_t) * 6 + 3 * sizeof(std::uint64_t)) +
         vertices * (sizeof(Vec4f) + sizeof(Quadric) + sizeof(Star) + 11) +
         tets * (sizeof(hypermesh::Tet) + 4 * sizeof(std::uint32_t) * (kRoomShare + 1) / kRoomShare);
}

}  // namespace tet4d::qslim4d
