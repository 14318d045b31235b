// Rounds of cheap edges that do not touch one another. Every edge's cost is kept with it and worked out anew only when
// one of its ends has moved, so a collapse costs the evaluation of the new vertex's edges and nothing else.
//
// A round: the edges up to a cost that about a quarter of the vertices' number of edges stay below; of those in order
// of cost, each whose ends no earlier one's star has claimed; all chosen ones are judged and collapsed in parallel. The
// choice is sequential and depends on costs and numbers only: the same result for any number of threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <utility>

#include "libpreprocess/qslim4d/orders.h"

namespace tet4d::qslim4d {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr std::size_t kChunk = 2048;  // items a task
// Edges looked at in a round, for each living vertex and for each collapse that is still to be made.
constexpr double kEdgesPerVertex = 0.25, kEdgesPerCollapse = 4;
constexpr std::uint64_t kTetsPerCollapse = 5;

class Passes {
 public:
  Passes(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger)
      : mesh_(mesh),
        options_(options),
        executor_(executor),
        ledger_(ledger),
        claimed_(mesh.positions.size(), 0),
        merged_(mesh.positions.size(), 0) {}

  void run() {
    std::vector<std::uint32_t> all;
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v)
      if (mesh_.head[v] != kNone) all.push_back(v), merged_[v] = 1;
    addEdgesOf(all);
    bool has_hope = true;  // whether something has changed since the banned edges were last tried
    while (!ledger_.isDone()) {
      ledger_.tell();
      ++ledger_.stats.rounds;
      choose();
      if (chosen_.empty()) {
        if (!has_hope || !unban()) return;
        has_hope = false;
        continue;
      }
      has_hope |= collapseChosen();
    }
  }

 private:
  struct Edge {
    std::uint32_t u, v;  // u < v
    float cost;          // kNever: not allowed as things were when it was last judged
  };
  struct Chosen {
    std::size_t edge;
    std::uint32_t u, v;
    Placement placement;
    Verdict verdict = Verdict::kAllowed;
    std::uint32_t removed = 0;
  };

  void inChunks(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& work) {
    executor_.run((count + kChunk - 1) / kChunk,
                  [&](std::size_t i) { work(i * kChunk, std::min(count, (i + 1) * kChunk)); });
  }

  float costOf(const Collapser& collapser, std::uint32_t u, std::uint32_t v) const {
    Placement placement;
    if (!collapser.evaluate(u, v, placement) || !ledger_.isAllowed(placement)) return kNever;
    return static_cast<float>(placement.cost);
  }

  // Appends the edges of `vertices`, whose merged_ is set; one between two of them once.
  void addEdgesOf(const std::vector<std::uint32_t>& vertices) {
    std::vector<std::vector<Edge>> found((vertices.size() + kChunk - 1) / kChunk);
    inChunks(vertices.size(), [&](std::size_t begin, std::size_t end) {
      Collapser collapser(mesh_, options_.rules);
      std::vector<Edge>& edges = found[begin / kChunk];
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t u = vertices[i];
        for (const std::uint32_t w : collapser.neighbours(u)) {
          if (merged_[w] != 0 && w < u) continue;
          const std::uint32_t a = std::min(u, w), b = std::max(u, w);
          edges.push_back({a, b, costOf(collapser, a, b)});
        }
      }
    });
    for (const std::vector<Edge>& edges : found) edges_.insert(edges_.end(), edges.begin(), edges.end());
    for (const std::uint32_t v : vertices) merged_[v] = 0;
  }

  // The cost that `count` edges stay at or below, to 1/128: by a histogram over the upper half of the floats.
  float costOfRank(std::size_t count) const {
    std::vector<std::uint32_t> histogram(std::size_t{1} << 16);
    for (const Edge& edge : edges_)
      if (edge.cost < kNever) ++histogram[std::bit_cast<std::uint32_t>(edge.cost) >> 16];
    std::size_t below = 0;
    for (std::uint32_t bin = 0; bin < histogram.size(); ++bin) {
      below += histogram[bin];
      if (below >= count) return std::bit_cast<float>(bin << 16 | 0xFFFFu);
    }
    return std::numeric_limits<float>::max();
  }

  void claimStar(std::uint32_t v) {
    claimed_[v] = stamp_;
    mesh_.forEachTet(v, [&](std::uint32_t tet, std::uint32_t) {
      for (const std::uint32_t w : mesh_.tets[tet]) claimed_[w] = stamp_;
    });
  }

  void choose() {
    const std::uint64_t need = mesh_.live_tets - std::min(mesh_.live_tets, options_.target_tets);
    const auto looked_at =
        static_cast<std::size_t>(16 + std::min(kEdgesPerVertex * static_cast<double>(mesh_.live_vertices),
                                               kEdgesPerCollapse * static_cast<double>(need / kTetsPerCollapse)));
    const float limit = costOfRank(looked_at);
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < edges_.size(); ++i)
      if (edges_[i].cost <= limit) candidates.push_back(i);
    std::sort(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) {
      const Edge &x = edges_[a], &y = edges_[b];
      if (x.cost != y.cost) return x.cost < y.cost;
      return std::pair(x.u, x.v) < std::pair(y.u, y.v);
    });
    chosen_.clear();
    ++stamp_;
    for (const std::size_t i : candidates) {
      if (chosen_.size() * kTetsPerCollapse > need) break;
      const auto [u, v, cost] = edges_[i];
      if (claimed_[u] == stamp_ || claimed_[v] == stamp_) continue;
      claimStar(u), claimStar(v);
      chosen_.push_back({i, u, v, {}, Verdict::kAllowed, 0});
    }
  }

  // True if a collapse was made.
  bool collapseChosen() {
    inChunks(chosen_.size(), [&](std::size_t begin, std::size_t end) {
      Collapser collapser(mesh_, options_.rules);
      for (std::size_t i = begin; i < end; ++i) {
        Chosen& chosen = chosen_[i];
        static_cast<void>(collapser.evaluate(chosen.u, chosen.v, chosen.placement));
        chosen.verdict = collapser.judge(chosen.u, chosen.v, chosen.placement.at);
        if (chosen.verdict == Verdict::kAllowed)
          chosen.removed = collapser.collapse(chosen.u, chosen.v, chosen.placement.at);
      }
    });
    std::vector<std::uint32_t> moved;
    for (const Chosen& chosen : chosen_) {
      ledger_.judged(chosen.verdict);
      edges_[chosen.edge].cost = kNever;
      if (chosen.verdict != Verdict::kAllowed) continue;
      ledger_.collapsed(chosen.removed, chosen.placement);
      moved.push_back(chosen.u);
      merged_[chosen.u] = merged_[chosen.v] = 1;
    }
    if (moved.empty()) return false;
    std::erase_if(edges_, [&](const Edge& edge) { return merged_[edge.u] != 0 || merged_[edge.v] != 0; });
    for (const Chosen& chosen : chosen_)
      if (chosen.verdict == Verdict::kAllowed) merged_[chosen.v] = 0;
    addEdgesOf(moved);
    return true;
  }

  // Gives every banned edge its cost back: what is around it may have changed. False if none has one.
  bool unban() {
    std::atomic<bool> any{false};
    inChunks(edges_.size(), [&](std::size_t begin, std::size_t end) {
      const Collapser collapser(mesh_, options_.rules);
      for (std::size_t i = begin; i < end; ++i) {
        if (edges_[i].cost < kNever) continue;
        edges_[i].cost = costOf(collapser, edges_[i].u, edges_[i].v);
        if (edges_[i].cost < kNever) any.store(true, std::memory_order_relaxed);
      }
    });
    return any;
  }

  SlimMesh& mesh_;
  const Options& options_;
  outofcore::Executor& executor_;
  Ledger& ledger_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> claimed_;  // by vertex: the round that claimed it last
  std::uint32_t stamp_ = 0;
  std::vector<std::uint8_t> merged_;  // by vertex: its edges are being made anew
  std::vector<Chosen> chosen_;
};

}  // namespace

void runPasses(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger) {
  Passes(mesh, options, executor, ledger).run();
}

}  // namespace tet4d::qslim4d
