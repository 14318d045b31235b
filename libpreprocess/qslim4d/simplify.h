// Simplifies a hypermesh by edge collapses under the 4D quadric error. Ponchio & Hormann 2008, sec. 5; Garland & Zhou
// 2005.
//
// In core. Deterministic: the result depends on the mesh and the options, not on the number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/qslim4d/collapse.h"
#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

enum class Order {
  kPasses,       // rounds of cheap edges that do not touch one another; parallel
  kMultichoice,  // the best of a few random edges, again and again (Wu & Kobbelt 2002; the paper's)
  kHeap,         // the cheapest edge of all, always: the reference
};

struct Options {
  Order order = Order::kPasses;
  std::uint64_t target_tets = 0;  // stop at or below; 0 with a finite error: as far as the error allows
  // World units: no collapse whose quadric says more is made. An estimate: the measured distance may be larger.
  double most_error = std::numeric_limits<double>::infinity();
  std::uint64_t choices = 8;  // of multichoice
  std::uint64_t seed = 0;     // of multichoice
  CollapseRules rules;
  std::size_t block_vertices = 4096;  // of passes: a mesh of many such blocks is swept block by block first
};

// Collapses by what they cost: a bin for every half octave.
inline constexpr std::size_t kCostBins = 512;
inline std::size_t costBin(double cost) {
  return cost > 0 ? static_cast<std::size_t>(std::clamp(2 * std::log2(cost) + 320, 0.0, double{kCostBins - 1})) : 0;
}

struct Stats {
  std::uint64_t collapses = 0;
  std::uint64_t aligned = 0;                       // of them with a time that an end or a frame has
  std::array<std::uint64_t, 6> verdicts{};         // edges judged, by Verdict
  std::uint64_t rounds = 0;                        // passes, or draws of multichoice
  std::array<std::uint32_t, kCostBins> removed{};  // tetrahedra, by costBin() of the collapse
  double largest_error = 0;                        // of the collapses made, by the quadrics: world units
  bool stalled = false;                            // no allowed collapse was left before the target was reached
};

// Collapses edges of `mesh` until a stop of `options` holds (phase "simplify"). Throws Error{kInterrupted}.
Stats simplify(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
