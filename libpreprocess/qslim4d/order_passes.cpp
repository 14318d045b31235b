// Blocks of a large mesh first (block_sweeps.h); then, on what is left, or on a small mesh from the begin:
//
// Rounds of cheap edges that do not touch one another. The cheap edges of the mesh are listed with their costs; a cost
// is worked out anew only when one of the edge's ends has moved. When few are left on the list all edges are looked at
// again, for a new one: the dear ones, which most edges are, take no memory. A list that led to nothing is followed by
// one of the next dearer edges, until there are none.
//
// A round: the edges up to a cost that about a quarter of the vertices' number of edges stay below; of those in order
// of cost, each whose ends no earlier one's star has claimed; all chosen ones are judged and collapsed in parallel. The
// choice is sequential and depends on costs and the list's order only: the same result for any number of threads.
#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <utility>

#include "libpreprocess/qslim4d/block_list.h"
#include "libpreprocess/qslim4d/block_sweeps.h"
#include "libpreprocess/qslim4d/cost_histogram.h"
#include "libpreprocess/qslim4d/cost_unit.h"
#include "libpreprocess/qslim4d/orders.h"

namespace tet4d::qslim4d {
namespace {

// Marks of a vertex: its star has changed; an edge at it has changed and was too dear for the list that is being made.
constexpr std::uint8_t kTouched = 1, kStillTouched = 2;
constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr std::size_t kChunk = 256;        // vertices or chosen edges a task
constexpr std::size_t kListBatch = 64;     // tasks whose edges wait to be joined to the list
constexpr std::size_t kSamples = 1 << 15;  // vertices whose edges tell how dear a list's dearest may be
// Edges that a list begins with, for each living vertex.
constexpr double kListPerVertex = 2.5;
// Edges looked at in a round, for each living vertex and for each collapse that is still to be made.
constexpr double kEdgesPerVertex = 0.25, kEdgesPerCollapse = 4;
constexpr std::uint64_t kTetsPerCollapse = 5;
// Of those looked at in a round, more than were asked for: costs that are as good as equal count as one.
constexpr std::uint64_t kMostEqual = 4;

class Passes {
 public:
  Passes(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger)
      : mesh_(mesh),
        options_(options),
        executor_(executor),
        ledger_(ledger),
        cost_unit_(costUnit(mesh)),
        claimed_(mesh.positions.size(), 0),
        merged_(mesh.positions.size(), 0),
        touched_(mesh.positions.size(), kTouched) {}

  void run() {
    if (!ledger_.isDone()) listEdges();
    while (!ledger_.isDone()) {
      ledger_.tell();
      if (choose()) {
        ++ledger_.stats.rounds;
        has_changed_ |= collapseChosen();
      } else if (has_changed_ || most_listed_ < kNever) {
        listEdges();
      } else {
        return;
      }
    }
  }

 private:
  struct Edge {
    std::uint32_t u, v;  // u < v
    float cost;          // kNever: not allowed as things were when it was last judged
  };
  struct Chosen {
    std::uint32_t u, v, edge;
    std::uint32_t removed;
    Verdict verdict;
    bool aligned;
    double cost, error;
  };

  void inChunks(std::size_t count, std::size_t chunk, const std::function<void(std::size_t, std::size_t)>& work) {
    executor_.run((count + chunk - 1) / chunk,
                  [&](std::size_t i) { work(i * chunk, std::min(count, (i + 1) * chunk)); });
  }

  float costOf(const Collapser& collapser, std::uint32_t u, std::uint32_t v) const {
    Placement placement;
    if (!collapser.evaluate(u, v, placement) || !ledger_.isAllowed(placement)) return kNever;
    return static_cast<float>(placement.cost * cost_unit_) + 0.0F;  // not -0, whose bits come last
  }

  // Whether the edge may be worth a place on the list, if it is dearer than known(): it has not been refused as things
  // are.
  float known(std::uint32_t u, std::uint32_t v) {
    const auto marks = [&](std::uint32_t w) { return std::atomic_ref(touched_[w]).load(std::memory_order_relaxed); };
    return ((marks(u) | marks(v)) & kTouched) != 0 ? least_ : std::max(least_, refused_);
  }

  // The cost that kListPerVertex edges a vertex that are worth it stay below, by a sample of vertices.
  float costToList() {
    const std::size_t stride = mesh_.positions.size() / kSamples | 1;
    const std::size_t count = (mesh_.positions.size() + stride - 1) / stride;
    std::vector<std::vector<float>> costs((count + kChunk - 1) / kChunk);
    inChunks(count, kChunk, [&](std::size_t begin, std::size_t end) {
      Collapser collapser(mesh_, options_.rules);
      for (std::size_t i = begin; i < end; ++i) {
        const auto u = static_cast<std::uint32_t>(i * stride);
        for (const std::uint32_t w : collapser.neighbours(u)) {
          const float cost = costOf(collapser, std::min(u, w), std::max(u, w));
          if (cost > known(u, w) && cost < kNever) costs[begin / kChunk].push_back(cost);
        }
      }
    });
    CostHistogram histogram;
    for (const std::vector<float>& some : costs)
      for (const float cost : some) histogram.add(cost);
    std::uint64_t used = 0;
    for (std::size_t i = 0; i < count; ++i) used += mesh_.isUsed(static_cast<std::uint32_t>(i * stride)) ? 1 : 0;
    // A sampled vertex shows all its edges, each of which has two ends.
    return histogram.ofRank(static_cast<std::uint64_t>(2 * kListPerVertex * static_cast<double>(used)) + 1);
  }

  // The list anew: of the cheapest edges of those that have not been refused yet, or whose surroundings have changed
  // since; where nothing has changed at all, of those dearer than the last list's. So a mesh with little left to
  // collapse is not judged again and again.
  void listEdges() {
    if (mesh_.corners_used > 4 * mesh_.live_tets) tidy(mesh_);
    for (std::size_t i = 0; i < edges_.size(); ++i)  // not looked at yet
      if (edges_[i].cost < kNever) touched_[edges_[i].u] = touched_[edges_[i].v] = kTouched;
    edges_.clear();
    least_ = has_changed_ ? -1 : most_listed_;
    most_listed_ = costToList();
    has_changed_ = false;
    join(mesh_.positions.size(), [&](Collapser& collapser, std::size_t i, std::vector<Edge>& edges) {
      const auto u = static_cast<std::uint32_t>(i);
      for (const std::uint32_t w : collapser.neighbours(u)) {
        const float least = u < w ? known(u, w) : kNever;
        if (least == kNever) continue;
        const float cost = costOf(collapser, u, w);
        if (cost <= least || cost == kNever) continue;
        if (cost <= most_listed_) {
          edges.push_back({u, w, cost});
        } else if (cost <= refused_) {
          for (const std::uint32_t v : {u, w})
            std::atomic_ref(touched_[v]).fetch_or(kStillTouched, std::memory_order_relaxed);
        }
      }
    });
    refused_ = std::max(refused_, most_listed_);
    for (std::uint8_t& touched : touched_) touched = touched / kStillTouched;
  }

  // Appends to the list what find(collapser, i, edges) gives for 0 <= i < count.
  template <class Find>
  void join(std::size_t count, const Find& find) {
    std::vector<std::vector<Edge>> found(kListBatch);
    for (std::size_t first = 0; first < count; first += kListBatch * kChunk) {
      inChunks(std::min(kListBatch * kChunk, count - first), kChunk, [&](std::size_t begin, std::size_t end) {
        Collapser collapser(mesh_, options_.rules);
        for (std::size_t i = begin; i < end; ++i) find(collapser, first + i, found[begin / kChunk]);
      });
      for (std::vector<Edge>& edges : found) {
        for (const Edge& edge : edges) edges_.push_back(edge);
        edges.clear();
      }
    }
  }

  void claimStar(std::uint32_t v) {
    claimed_[v] = stamp_;
    mesh_.forEachTet(v, [&](std::uint32_t tet, std::uint32_t) {
      for (const std::uint32_t w : mesh_.tets[tet]) claimed_[w] = stamp_;
    });
  }

  // What the edges after the k-th will read, in the order in which one address leads to the next.
  void fetchAhead(const std::vector<std::uint64_t>& keys, std::size_t k) const {
    const auto edgeAt = [&](std::size_t at) {
      return edges_[static_cast<std::uint32_t>(keys[std::min(at, keys.size() - 1)])];
    };
    __builtin_prefetch(&edges_[static_cast<std::uint32_t>(keys[std::min(k + 16, keys.size() - 1)])]);
    const Edge far = edgeAt(k + 12), near = edgeAt(k + 8), next = edgeAt(k + 4);
    for (const std::uint32_t v : {far.u, far.v}) __builtin_prefetch(&mesh_.stars[v]), __builtin_prefetch(&claimed_[v]);
    for (const std::uint32_t v : {near.u, near.v})
      if (claimed_[v] != stamp_) __builtin_prefetch(mesh_.starOf(v).data());
    if (claimed_[next.u] != stamp_ && claimed_[next.v] != stamp_)
      mesh_.prefetchStar(next.u), mesh_.prefetchStar(next.v);
  }

  // The listed edges at or below the cost of rank `look`, cheapest first: cost and number in one. Of many that cost as
  // good as the same those first on the list.
  std::vector<std::uint64_t> candidates(std::uint64_t look, const CostHistogram& histogram) const {
    const float limit = histogram.ofRank(look);
    const std::uint32_t last_bin = CostHistogram::binOf(limit);
    std::uint64_t room = kMostEqual * look;  // for the last bin's, below which are fewer than `look`
    std::vector<std::uint64_t> keys;
    keys.reserve(std::min<std::uint64_t>(histogram.total(), (1 + kMostEqual) * look));
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const float cost = edges_[i].cost;
      if (cost > limit || cost == kNever) continue;
      if (CostHistogram::binOf(cost) == last_bin) {
        if (room == 0) continue;
        --room;
      }
      keys.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(cost)} << 32 | i);
    }
    std::sort(keys.begin(), keys.end());
    return keys;
  }

  // False if too few edges are left on the list: none, if it has led to nothing yet.
  bool choose() {
    const std::uint64_t need = mesh_.live_tets - std::min(mesh_.live_tets, options_.target_tets);
    const auto look =
        static_cast<std::uint64_t>(16 + std::min(kEdgesPerVertex * static_cast<double>(mesh_.live_vertices),
                                                 kEdgesPerCollapse * static_cast<double>(need) / kTetsPerCollapse));
    CostHistogram histogram;
    for (std::size_t i = 0; i < edges_.size(); ++i)
      if (edges_[i].cost < kNever) histogram.add(edges_[i].cost);
    if (histogram.total() == 0 || (histogram.total() < look && most_listed_ < kNever && has_changed_)) return false;
    chosen_.clear();
    ++stamp_;
    const std::vector<std::uint64_t> keys = candidates(look, histogram);
    // New corners of a round, at most: those of the two stars of each.
    std::uint64_t room = 4 * mesh_.live_tets / kMostNewShare;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      if (chosen_.size() * kTetsPerCollapse > need) break;
      const auto i = static_cast<std::uint32_t>(keys[k]);
      fetchAhead(keys, k);
      const auto [u, v, cost] = edges_[i];
      if (claimed_[u] == stamp_ || claimed_[v] == stamp_) continue;
      const std::uint64_t corners = std::uint64_t{mesh_.stars[u].size} + mesh_.stars[v].size;
      if (corners > room && !chosen_.empty()) break;
      room -= std::min(room, corners);
      claimStar(u), claimStar(v);
      chosen_.push_back({u, v, i, 0, Verdict::kAllowed, false, 0, 0});
    }
    // What lies side by side in memory is collapsed one after the other.
    std::sort(chosen_.begin(), chosen_.end(), [](const Chosen& a, const Chosen& b) { return a.u < b.u; });
    return true;
  }

  // True if a collapse was made.
  bool collapseChosen() {
    std::uint64_t corners = 0;
    for (const Chosen& chosen : chosen_)
      corners += std::uint64_t{mesh_.stars[chosen.u].size} + mesh_.stars[chosen.v].size;
    makeRoom(mesh_, corners);
    inChunks(chosen_.size(), kChunk, [&](std::size_t begin, std::size_t end) {
      Collapser collapser(mesh_, options_.rules);
      for (std::size_t i = begin; i < end; ++i) {
        Chosen& chosen = chosen_[i];
        Placement placement;
        static_cast<void>(collapser.evaluate(chosen.u, chosen.v, placement));
        chosen.aligned = placement.aligned, chosen.cost = placement.cost, chosen.error = placement.error;
        chosen.verdict = collapser.judge(chosen.u, chosen.v, placement.at);
        if (chosen.verdict == Verdict::kAllowed) chosen.removed = collapser.merge(chosen.u, chosen.v, placement.at);
      }
    });
    std::vector<std::uint32_t> moved;
    for (const Chosen& chosen : chosen_) {
      ledger_.judged(chosen.verdict);
      edges_[chosen.edge].cost = kNever;
      if (chosen.verdict != Verdict::kAllowed) continue;
      ledger_.collapsed(chosen.removed, chosen.cost, chosen.aligned, chosen.error);
      moved.push_back(chosen.u);
      merged_[chosen.u] = merged_[chosen.v] = 1;
    }
    if (moved.empty()) return false;
    edges_.eraseIf([&](const Edge& edge) { return merged_[edge.u] != 0 || merged_[edge.v] != 0; });
    for (const Chosen& chosen : chosen_) merged_[chosen.v] = 0;
    // An edge between two that moved is listed by the one with the smaller number.
    join(moved.size(), [&](Collapser& collapser, std::size_t i, std::vector<Edge>& edges) {
      const std::uint32_t u = moved[i];
      for (const std::uint32_t w : collapser.neighbours(u)) {
        std::atomic_ref(touched_[w]).store(kTouched, std::memory_order_relaxed);
        if (merged_[w] != 0 && w < u) continue;
        const std::uint32_t a = std::min(u, w), b = std::max(u, w);
        if (const float cost = costOf(collapser, a, b); cost <= most_listed_ && cost < kNever)
          edges.push_back({a, b, cost});
      }
    });
    for (const std::uint32_t v : moved) merged_[v] = 0, touched_[v] = kTouched;
    return true;
  }

  SlimMesh& mesh_;
  const Options& options_;
  outofcore::Executor& executor_;
  Ledger& ledger_;
  double cost_unit_;
  BlockList<Edge> edges_;
  float least_ = -1;                    // no edge of this cost or less was put on the list
  float most_listed_ = 0;               // no edge dearer than this is on the list
  float refused_ = -1;                  // up to this cost, an edge of untouched ends is on the list or was refused
  bool has_changed_ = true;             // since the list was made
  std::vector<std::uint32_t> claimed_;  // by vertex: the round that claimed it last
  std::uint32_t stamp_ = 0;
  std::vector<std::uint8_t> merged_;   // by vertex: its edges are being made anew
  std::vector<std::uint8_t> touched_;  // by vertex: whether its star has changed since its edges were last listed
  std::vector<Chosen> chosen_;
};

}  // namespace

std::uint64_t orderBytes(std::uint64_t vertices, std::uint64_t tets) {
  // The heap takes 20 bytes a vertex, multichoice 4 a tetrahedron. Passes: marks; the list, which holds every edge once
  // if all cost the same, and a mesh has as many as vertices and tetrahedra, and half its free faces; what a round
  // looks at; what it chooses, no two beside one another; what waits to be joined to the list.
  constexpr std::uint64_t kMarks = 6, kEdge = 12, kChosen = 16;
  const auto looked = static_cast<std::uint64_t>(kEdgesPerVertex * (1 + kMostEqual) * static_cast<double>(vertices));
  const std::uint64_t waiting = std::min<std::uint64_t>(kListBatch * kChunk, vertices) * 16 * kEdge;
  const std::uint64_t rounds = vertices * (kMarks + kChosen) + (2 * vertices + tets) * kEdge +
                               looked * sizeof(std::uint64_t) + waiting + (std::uint64_t{1} << 20);
  // Sweeps give the mesh's corners back while they last.
  const std::uint64_t sweeps = sweepBytes(vertices, tets, Options().block_vertices),
                      corners = tets * 4 * sizeof(std::uint32_t);
  return std::max(rounds, sweeps - std::min(sweeps, corners));
}

void runPasses(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger) {
  sweepBlocks(mesh, options, executor, ledger);
  Passes(mesh, options, executor, ledger).run();
}

}  // namespace tet4d::qslim4d
