// The three orders of collapses behind simplify(). Private to qslim4d.
#pragma once

#include "libpreprocess/qslim4d/simplify.h"

namespace tet4d::qslim4d {

// What every order counts and asks.
class Ledger {
 public:
  Ledger(SlimMesh& mesh, const Options& options, outofcore::Progress& progress)
      : mesh_(mesh), options_(options), progress_(progress), most_error_(options.most_error / mesh.space.cell) {
    start_ = mesh.live_tets;
  }
  bool isDone() const { return mesh_.live_tets <= options_.target_tets; }
  bool isAllowed(const Placement& placement) const { return isAllowed(placement.error); }
  bool isAllowed(double error) const { return error <= most_error_; }  // mean cells
  void judged(Verdict verdict) { ++stats.verdicts[static_cast<std::size_t>(verdict)]; }
  void collapsed(std::uint32_t removed, const Placement& placement) {
    collapsed(removed, placement.cost, placement.aligned, placement.error);
  }
  void collapsed(std::uint32_t removed, double cost, bool aligned, double error) {
    mesh_.live_tets -= removed;
    --mesh_.live_vertices;
    ++stats.collapses;
    stats.removed[costBin(cost)] += removed;
    stats.aligned += aligned ? 1 : 0;
    stats.largest_error = std::max(stats.largest_error, error * mesh_.space.cell);
  }
  // What has been done in a part of the mesh, which has counted on its own.
  void add(const Stats& part) {
    for (const std::uint32_t removed : part.removed) mesh_.live_tets -= removed;
    mesh_.live_vertices -= part.collapses;
    stats.collapses += part.collapses;
    stats.aligned += part.aligned;
    for (std::size_t i = 0; i < stats.verdicts.size(); ++i) stats.verdicts[i] += part.verdicts[i];
    for (std::size_t i = 0; i < stats.removed.size(); ++i) stats.removed[i] += part.removed[i];
    stats.largest_error = std::max(stats.largest_error, part.largest_error);
  }
  void tell() { progress_.step(start_ - mesh_.live_tets); }

  Stats stats;

 private:
  SlimMesh& mesh_;
  const Options& options_;
  outofcore::Progress& progress_;
  double most_error_;  // mean cells
  std::uint64_t start_ = 0;
};

// Bytes that the one of them that takes most holds at most beside the mesh.
std::uint64_t orderBytes(std::uint64_t vertices, std::uint64_t tets);

void runHeap(SlimMesh& mesh, const Options& options, Ledger& ledger);
void runMultichoice(SlimMesh& mesh, const Options& options, Ledger& ledger);
void runPasses(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger);

}  // namespace tet4d::qslim4d
