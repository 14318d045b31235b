// The best of a few random edges, again and again: no order is kept, so nothing has to be brought up to date.
// Wu & Kobbelt 2002; Vo et al. 2005; Ponchio & Hormann 2008, sec. 5.
//
// On a mesh with little left the cheapest edges are those that may not be collapsed, and one of them is the best of
// nearly every draw: with 8 choices an edge that is dearer than four fifths of all is the best of one in 78,000 draws
// that it is in. So where few draws lead to anything all edges are looked at, in the order of their costs, and those
// allowed are collapsed before chance goes on; a look that finds none ends the run.
#include <algorithm>
#include <utility>
#include <vector>

#include "libpreprocess/qslim4d/orders.h"

namespace tet4d::qslim4d {
namespace {

constexpr std::uint64_t kTellEvery = 4096;  // draws
// Draws are in vain when fewer than one in so many led to a collapse while as many edges were drawn as there are
// tetrahedra.
constexpr std::uint64_t kVainShare = 64;
// Vertices that one look at all edges takes away, at most: a share of them, and so many more.
constexpr std::uint64_t kScanShare = 16, kScanMore = 16;

// PCG (O'Neill 2014): small, and the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed + 0x9E3779B97F4A7C15U) { next(); }
  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005U + 1442695040888963407U;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return shifted >> turn | shifted << (-turn & 31u);
  }
  // 0 .. below - 1.
  std::uint32_t next(std::uint32_t below) { return static_cast<std::uint32_t>(std::uint64_t{next()} * below >> 32); }

 private:
  std::uint64_t state_;
};

class Multichoice {
 public:
  Multichoice(SlimMesh& mesh, const Options& options, Ledger& ledger)
      : mesh_(mesh), options_(options), ledger_(ledger), collapser_(mesh, options.rules), random_(options.seed) {
    listLive();
  }

  void run() {
    std::uint64_t draws = 0, hits = 0;
    while (!ledger_.isDone()) {
      if (ledger_.stats.rounds++ % kTellEvery == 0) ledger_.tell();
      if (live_.size() > 2 * mesh_.live_tets) listLive();
      hits += drawAndCollapse() ? 1 : 0;
      if (++draws * options_.choices < mesh_.live_tets) continue;
      if (hits * kVainShare < draws && !scanAndCollapse()) return;
      draws = hits = 0;
    }
  }

 private:
  struct Choice {
    Placement placement;
    std::uint32_t u, v;
  };
  struct Edge {
    double cost;
    std::uint32_t u, v;  // u < v
  };

  void listLive() {
    live_.clear();
    live_.reserve(mesh_.live_tets);
    for (std::uint32_t tet = 0; tet < mesh_.tets.size(); ++tet)
      if (mesh_.isLive(tet)) live_.push_back(tet);
  }

  // An edge of a random tetrahedron: edges of many tetrahedra come up more often, and their collapses save more.
  std::pair<std::uint32_t, std::uint32_t> randomEdge() {
    static constexpr std::uint8_t kEnds[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    for (;;) {
      const std::uint32_t tet = live_[random_.next(static_cast<std::uint32_t>(live_.size()))];
      const auto& ends = kEnds[random_.next(6)];
      if (!mesh_.isLive(tet)) continue;
      const std::uint32_t a = mesh_.tets[tet][ends[0]], b = mesh_.tets[tet][ends[1]];
      return {std::min(a, b), std::max(a, b)};
    }
  }

  bool drawAndCollapse() {
    choices_.clear();
    for (std::uint64_t i = 0; i < options_.choices; ++i) {
      const auto [u, v] = randomEdge();
      Placement placement;
      if (collapser_.evaluate(u, v, placement) && ledger_.isAllowed(placement)) choices_.push_back({placement, u, v});
    }
    std::sort(choices_.begin(), choices_.end(), [](const Choice& a, const Choice& b) {
      if (a.placement.cost != b.placement.cost) return a.placement.cost < b.placement.cost;
      return std::pair(a.u, a.v) < std::pair(b.u, b.v);
    });
    // The cheapest only: taking the next one when it is not allowed would take dear edges where cheap ones are stuck.
    if (choices_.empty()) return false;
    const Choice& choice = choices_.front();
    const Verdict verdict = collapser_.judge(choice.u, choice.v, choice.placement.at);
    ledger_.judged(verdict);
    if (verdict != Verdict::kAllowed) return false;
    const std::size_t tets = mesh_.tets.size();
    ledger_.collapsed(collapser_.collapse(choice.u, choice.v, choice.placement.at), choice.placement);
    if (mesh_.tets.size() != tets) listLive();  // they have new numbers
    return true;
  }

  template <class Visit>
  void forEachEdge(const Visit& visit) {
    for (std::uint32_t u = 0; u < mesh_.positions.size(); ++u) {
      if (!mesh_.isUsed(u)) continue;
      for (const std::uint32_t v : collapser_.neighbours(u))
        if (u < v) visit(u, v);
    }
  }

  // All edges as they are now, cheapest first; those whose surroundings have not changed meanwhile are collapsed if
  // that is allowed, until enough are. False if none is.
  bool scanAndCollapse() {
    release(live_);  // the edges take more than anything else
    std::size_t count = 0;
    forEachEdge([&](std::uint32_t, std::uint32_t) { ++count; });
    std::vector<Edge> edges;
    edges.reserve(count);
    forEachEdge([&](std::uint32_t u, std::uint32_t v) {
      Placement placement;
      if (collapser_.evaluate(u, v, placement) && ledger_.isAllowed(placement)) edges.push_back({placement.cost, u, v});
    });
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return a.cost != b.cost ? a.cost < b.cost : std::pair(a.u, a.v) < std::pair(b.u, b.v);
    });
    const std::uint64_t most = mesh_.live_vertices / kScanShare + kScanMore;
    std::uint64_t made = 0;
    changed_.assign(mesh_.positions.size(), 0);
    for (const auto& [cost, u, v] : edges) {
      if (ledger_.isDone() || made == most) break;
      if (changed_[u] != 0 || changed_[v] != 0) continue;
      Placement placement;
      if (!collapser_.evaluate(u, v, placement)) continue;
      const Verdict verdict = collapser_.judge(u, v, placement.at);
      ledger_.judged(verdict);
      if (verdict != Verdict::kAllowed) continue;
      ledger_.collapsed(collapser_.collapse(u, v, placement.at), placement);
      ++made;
      changed_[u] = changed_[v] = 1;
      for (const std::uint32_t w : collapser_.neighbours(u)) changed_[w] = 1;
    }
    ledger_.tell();
    listLive();  // a collapse may have given tetrahedra new numbers
    return made > 0;
  }

  SlimMesh& mesh_;
  const Options& options_;
  Ledger& ledger_;
  Collapser collapser_;
  Random random_;
  std::vector<std::uint32_t> live_;
  std::vector<Choice> choices_;
  std::vector<std::uint8_t> changed_;  // by vertex, while all edges are looked at
};

}  // namespace

void runMultichoice(SlimMesh& mesh, const Options& options, Ledger& ledger) {
  if (mesh.live_tets > 0) Multichoice(mesh, options, ledger).run();
}

}  // namespace tet4d::qslim4d
