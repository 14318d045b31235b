// The cheapest allowed edge of the whole mesh, always. A heap of vertices by their cheapest edge, each vertex in it at
// most once: no stale entries, whatever the mesh.
#include <algorithm>
#include <limits>
#include <utility>

#include "libpreprocess/qslim4d/orders.h"

namespace tet4d::qslim4d {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kTellEvery = 4096;  // collapses

class HeapOrder {
 public:
  HeapOrder(SlimMesh& mesh, const Options& options, Ledger& ledger)
      : mesh_(mesh), ledger_(ledger), collapser_(mesh, options.rules), best_(mesh.positions.size()) {
    heap_.reserve(best_.size());
  }

  void run() {
    for (std::uint32_t v = 0; v < best_.size(); ++v)
      if (mesh_.isUsed(v)) scan(v);
    for (std::uint64_t n = 0; !ledger_.isDone() && !heap_.empty(); ++n) {
      if (n % kTellEvery == 0) ledger_.tell();
      collapseTop();
    }
  }

 private:
  struct Best {
    double cost = kNever;
    std::uint32_t partner = kNone;
    std::uint32_t place = kNone;  // in the heap
  };

  bool isBefore(std::uint32_t a, std::uint32_t b) const {
    return best_[a].cost != best_[b].cost ? best_[a].cost < best_[b].cost : a < b;
  }
  void put(std::size_t place, std::uint32_t v) {
    heap_[place] = v;
    best_[v].place = static_cast<std::uint32_t>(place);
  }
  void rise(std::size_t place) {
    const std::uint32_t v = heap_[place];
    while (place > 0 && isBefore(v, heap_[(place - 1) / 2])) {
      put(place, heap_[(place - 1) / 2]);
      place = (place - 1) / 2;
    }
    put(place, v);
  }
  void sink(std::size_t place) {
    const std::uint32_t v = heap_[place];
    for (std::size_t child = 2 * place + 1; child < heap_.size(); child = 2 * place + 1) {
      if (child + 1 < heap_.size() && isBefore(heap_[child + 1], heap_[child])) ++child;
      if (!isBefore(heap_[child], v)) break;
      put(place, heap_[child]);
      place = child;
    }
    put(place, v);
  }
  void remove(std::uint32_t v) {
    const std::size_t place = best_[v].place;
    if (place == kNone) return;
    best_[v].place = kNone;
    const std::uint32_t moved = heap_.back();
    heap_.pop_back();
    if (moved == v) return;
    put(place, moved);
    rise(place);
    sink(best_[moved].place);
  }
  void set(std::uint32_t v, double cost, std::uint32_t partner) {
    best_[v].cost = cost, best_[v].partner = partner;
    if (cost == kNever) return remove(v);
    if (best_[v].place == kNone) {
      heap_.push_back(v);
      best_[v].place = static_cast<std::uint32_t>(heap_.size() - 1);
    }
    rise(best_[v].place);
    sink(best_[v].place);
  }

  // The cheapest edge at v, judged or not.
  void scan(std::uint32_t v) {
    double cost = kNever;
    std::uint32_t partner = kNone;
    for (const std::uint32_t w : collapser_.neighbours(v)) {
      Placement placement;
      if (!collapser_.evaluate(std::min(v, w), std::max(v, w), placement) || !ledger_.isAllowed(placement)) continue;
      if (placement.cost < cost || (placement.cost == cost && w < partner)) cost = placement.cost, partner = w;
    }
    set(v, cost, partner);
  }

  // The cheapest edge at v that is allowed; kNever until something near changes if there is none.
  void scanJudged(std::uint32_t v) {
    std::vector<std::pair<double, std::uint32_t>> edges;
    for (const std::uint32_t w : collapser_.neighbours(v)) {
      Placement placement;
      if (collapser_.evaluate(std::min(v, w), std::max(v, w), placement) && ledger_.isAllowed(placement))
        edges.emplace_back(placement.cost, w);
    }
    std::sort(edges.begin(), edges.end());
    for (const auto& [cost, w] : edges) {
      Placement placement;
      static_cast<void>(collapser_.evaluate(std::min(v, w), std::max(v, w), placement));
      const Verdict verdict = collapser_.judge(std::min(v, w), std::max(v, w), placement.at);
      ledger_.judged(verdict);
      if (verdict == Verdict::kAllowed) return set(v, cost, w);
    }
    set(v, kNever, kNone);
  }

  void collapseTop() {
    const std::uint32_t top = heap_.front(), u = std::min(top, best_[top].partner),
                        v = std::max(top, best_[top].partner);
    Placement placement;
    static_cast<void>(collapser_.evaluate(u, v, placement));
    const Verdict verdict = collapser_.judge(u, v, placement.at);
    ledger_.judged(verdict);
    if (verdict != Verdict::kAllowed) return scanJudged(top);
    remove(v);
    ledger_.collapsed(collapser_.collapse(u, v, placement.at), placement);
    const auto around = collapser_.neighbours(u);
    const std::vector<std::uint32_t> neighbours(around.begin(), around.end());
    scan(u);
    for (const std::uint32_t w : neighbours) {
      if (best_[w].partner == u || best_[w].partner == v || best_[w].partner == kNone) {
        scan(w);
        continue;
      }
      if (collapser_.evaluate(std::min(u, w), std::max(u, w), placement) && ledger_.isAllowed(placement) &&
          placement.cost < best_[w].cost)
        set(w, placement.cost, u);
    }
  }

  SlimMesh& mesh_;
  Ledger& ledger_;
  Collapser collapser_;
  std::vector<Best> best_;
  std::vector<std::uint32_t> heap_;
};

}  // namespace

void runHeap(SlimMesh& mesh, const Options& options, Ledger& ledger) { HeapOrder(mesh, options, ledger).run(); }

}  // namespace tet4d::qslim4d
