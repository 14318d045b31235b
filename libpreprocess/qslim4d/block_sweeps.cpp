#include "libpreprocess/qslim4d/block_sweeps.h"

#include <algorithm>
#include <atomic>
#include <memory>

#include "libpreprocess/qslim4d/block_work.h"
#include "libpreprocess/qslim4d/cost_histogram.h"
#include "libpreprocess/qslim4d/cost_unit.h"

namespace tet4d::qslim4d {
namespace {

constexpr std::size_t kLeastBlocks = 8;  // a smaller mesh is left to the rounds
constexpr std::size_t kMostSweeps = 16;
constexpr std::size_t kBatch = 64;  // blocks between two reports
// At most one of so many blocks is worked on at a time: scratch space is a small part of the mesh.
constexpr std::size_t kBlocksPerWorker = 8;
// A sweep's edges are those up to a cost that so many stay below, for each collapse that is still to be made: about a
// tenth of them are collapsed, for a third of the vertices is shared by blocks and most edges have gone with others.
constexpr double kEdgesPerCollapse = 5;
constexpr double kTetsPerCollapse = 5.5;
// Sweeps end when what is left to do, or what the last one did, is a smaller share of the vertices.
constexpr double kLeastToDo = 0.05, kLeastDone = 0.02;
// Of what is to be removed, no more than this; and for each block less, for its last collapse may remove more.
constexpr double kMostShare = 1 - 1.0 / 64, kTetsSpared = 8;
// Tetrahedra whose edges are priced to tell how dear a sweep's may be: one of so many, so many at least.
constexpr std::size_t kTetsPerSample = 256, kLeastSamples = 2048, kSampleChunk = 64;

class Sweeps {
 public:
  Sweeps(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger)
      : mesh_(mesh), options_(options), executor_(executor), ledger_(ledger), cost_unit_(costUnit(mesh)) {}

  void run() {
    for (std::size_t sweep = 0; sweep < kMostSweeps; ++sweep) {
      const auto to_remove = static_cast<double>(mesh_.live_tets - std::min(mesh_.live_tets, options_.target_tets));
      const auto vertices = static_cast<double>(mesh_.live_vertices);
      if (mesh_.live_vertices < kLeastBlocks * options_.block_vertices) return;
      if (to_remove < kLeastToDo * kTetsPerCollapse * vertices) return;
      const std::uint64_t before = ledger_.stats.collapses;
      runSweep(sweep, to_remove);
      if (static_cast<double>(ledger_.stats.collapses - before) < kLeastDone * vertices) return;
    }
  }

 private:
  struct Sample {
    float cost;
    std::uint32_t vertex;  // one end
  };

  void runSweep(std::size_t sweep, double to_remove) {
    std::erase_if(mesh_.tets, [](const hypermesh::Tet& tet) { return tet[0] == kNone; });
    const VertexBlocks blocks = cutBlocks(mesh_, options_.block_vertices, sweep, executor_);
    const std::vector<BlockLimits> limits = limitsOf(blocks, to_remove);
    for (std::size_t first = 0; first < blocks.count(); first += kBatch) {
      std::vector<Stats> stats(std::min(kBatch, blocks.count() - first));
      std::atomic<std::size_t> next{0};
      workers_.resize(std::max(workers_.size(), blocks.count() / kBlocksPerWorker + 1));
      executor_.run(std::min(stats.size(), workers_.size()), [&](std::size_t worker) {
        std::unique_ptr<BlockWork>& work = workers_[worker];
        for (std::size_t i = next++; i < stats.size(); i = next++) {
          if (!work) work = std::make_unique<BlockWork>(mesh_, options_);
          stats[i] = work->run(mesh_, blocks, first + i, limits[first + i]);
        }
      });
      for (const Stats& part : stats) ledger_.add(part);
      ledger_.tell();
    }
    ++ledger_.stats.rounds;
  }

  // All six edges of some tetrahedra, those that are allowed.
  std::vector<Sample> sample(std::size_t tets) const {
    std::vector<std::vector<Sample>> found((tets + kSampleChunk - 1) / kSampleChunk);
    executor_.run(found.size(), [&](std::size_t chunk) {
      const Collapser collapser(mesh_, options_.rules);
      for (std::size_t i = chunk * kSampleChunk; i < std::min(tets, (chunk + 1) * kSampleChunk); ++i) {
        const hypermesh::Tet& tet = mesh_.tets[i * mesh_.tets.size() / tets];
        for (std::size_t a = 0; a < 4; ++a) {
          for (std::size_t b = a + 1; b < 4; ++b) {
            Placement placement;
            const std::uint32_t u = std::min(tet[a], tet[b]), v = std::max(tet[a], tet[b]);
            if (collapser.evaluate(u, v, placement) && ledger_.isAllowed(placement))
              found[chunk].push_back({static_cast<float>(placement.cost * cost_unit_), u});
          }
        }
      }
    });
    std::vector<Sample> all;
    for (const std::vector<Sample>& some : found) all.insert(all.end(), some.begin(), some.end());
    return all;
  }

  // One cost for all blocks. A block may remove as much of what is to go as it has cheap edges of all: where costs are
  // as good as equal, they say nothing of how many edges stay below.
  std::vector<BlockLimits> limitsOf(const VertexBlocks& blocks, double to_remove) const {
    const std::size_t tets = std::min(mesh_.tets.size(), std::max(mesh_.tets.size() / kTetsPerSample, kLeastSamples));
    const std::vector<Sample> samples = sample(tets);
    CostHistogram histogram;
    for (const Sample& some : samples) histogram.add(some.cost);
    // A closed mesh has as many edges as vertices and tetrahedra.
    const double edges = static_cast<double>(mesh_.live_vertices + mesh_.live_tets);
    const double wanted = kEdgesPerCollapse * to_remove / kTetsPerCollapse;
    const float cost = histogram.ofRank(static_cast<std::uint64_t>(wanted / edges * 6 * static_cast<double>(tets)) + 1);
    std::vector<double> cheap(blocks.count(), 1);
    double all = static_cast<double>(cheap.size());
    for (const Sample& some : samples) {
      if (!(some.cost <= cost)) continue;
      const auto after = std::upper_bound(blocks.begins.begin(), blocks.begins.end(), blocks.places[some.vertex]);
      ++cheap[static_cast<std::size_t>(after - blocks.begins.begin() - 1)], ++all;
    }
    std::vector<BlockLimits> limits;
    for (const double here : cheap)
      limits.push_back({cost, cost_unit_,
                        static_cast<std::uint64_t>(std::max(0.0, kMostShare * to_remove * here / all - kTetsSpared))});
    return limits;
  }

  SlimMesh& mesh_;
  const Options& options_;
  outofcore::Executor& executor_;
  Ledger& ledger_;
  double cost_unit_;
  std::vector<std::unique_ptr<BlockWork>> workers_;
};

}  // namespace

void sweepBlocks(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger) {
  if (ledger.isDone() || mesh.live_vertices < kLeastBlocks * options.block_vertices) return;
  release(mesh.corners);  // blocks have corners of their own
  Sweeps(mesh, options, executor, ledger).run();
  mesh.corners_used = 0;
  makeRoom(mesh, mesh.live_tets / kMostNewShare + 1);
}

std::uint64_t sweepBytes(std::uint64_t vertices, std::uint64_t tets, std::size_t block_vertices) {
  const std::uint64_t blocks = vertices / std::max<std::size_t>(1, block_vertices);
  if (blocks < kLeastBlocks) return 0;
  // Blocks may differ in how many tetrahedra they have.
  return blockListBytes(vertices, tets) +
         (blocks / kBlocksPerWorker + 1) * blockWorkBytes(block_vertices, 2 * tets / blocks);
}

}  // namespace tet4d::qslim4d
