#include "libpreprocess/qslim4d/sweep.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <string>
#include <utility>

#include "libpreprocess/qslim4d/attributes.h"
#include "libpreprocess/qslim4d/mesh_file.h"

namespace tet4d::qslim4d {
namespace {

// What a cell says of its progress: nothing but that it may be interrupted.
class CellProgress final : public outofcore::Progress {
 public:
  void step(std::uint64_t /*done*/) override { outofcore::Progress::step(0); }
};

std::string journalLine(const SweepTask& task, std::size_t cell) {
  return "cell " + std::to_string(task.sweep) + " " + std::to_string(cell) + task.which.suffix();
}

void runCell(const SweepTask& task, std::size_t cell, outofcore::WorkFolder& folder, outofcore::Executor& executor) {
  const CellPaths paths(folder, task.sweep, task.which);
  const bool first = task.sweep == 0;
  LoadedCell loaded = loadCell(paths, cell, !first, task.columns);
  const CellContext context{loaded.flags, loaded.quadrics, loaded.ids, task.speed};
  SlimMesh mesh = makeSlimMesh(std::move(loaded.positions), std::move(loaded.tets), task.domain, task.map, task.metric,
                               {task.keep_non_manifold, &executor, &context});
  release(loaded.flags), release(loaded.quadrics);
  NonManifold found;
  if (task.keep_non_manifold) found = lockNonManifold(mesh, first);
  mesh.columns = std::move(loaded.columns);
  // Those of later sweeps have come with the quadrics.
  if (first) addAttributeQuadrics(mesh, task.metric);
  Options options = task.options;
  options.target_tets = task.targets[cell];
  // Every cell draws edges of its own.
  options.seed += (std::uint64_t{task.sweep} << 32 | cell) * 0x9E3779B97F4A7C15u;
  CellProgress progress;
  const Stats stats = simplify(mesh, options, executor, progress);
  writeResult(paths.result(cell), mesh, loaded.ids, first, stats, found);
  folder.record(journalLine(task, cell));
  removeCell(paths, cell);
}

}  // namespace

std::uint64_t cellBytes(const CellSize& cell, const VertexLoad& load) {
  // The vertices' own numbers stay, what columns have is loaded to its place, and quadrics are copied from what was
  // loaded.
  const std::uint64_t beside = cell.vertices * (sizeof(std::uint64_t) + sizeof(Quadric) + load.bytes());
  return std::max(loadBytes(cell.slots, cell.tets), simplifyBytes(cell.vertices, cell.tets)) + beside;
}

std::size_t runSweep(const SweepTask& task, outofcore::WorkFolder& folder, outofcore::Executor& executor,
                     outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  std::vector<std::size_t> open;  // the largest first
  CellSize largest;
  for (std::size_t i = 0; i < task.cells.size(); ++i) {
    if (folder.isDone(journalLine(task, i))) continue;
    open.push_back(i);
    largest = {std::max(largest.tets, task.cells[i].tets), std::max(largest.slots, task.cells[i].slots),
               std::max(largest.vertices, task.cells[i].vertices), 0, 0};
  }
  if (open.empty()) return 0;
  std::stable_sort(open.begin(), open.end(),
                   [&](std::size_t a, std::size_t b) { return task.cells[a].tets > task.cells[b].tets; });
  const std::uint64_t bytes = cellBytes(largest, loadOf(task.columns));
  const std::size_t in_flight = std::max<std::size_t>(
      1, std::min({executor.threads(), open.size(), static_cast<std::size_t>(memory.available() / bytes)}));
  const auto reserved = memory.reserve(in_flight * bytes, "a cell while it is simplified");
  progress.phase("simplify", open.size());
  // One cell has all threads to itself; of several each has one.
  std::atomic<std::size_t> next{0}, done{0};
  executor.run(in_flight, [&](std::size_t) {
    for (std::size_t i = next++; i < open.size(); i = next++) {
      runCell(task, open[i], folder, executor);
      progress.step(++done);
    }
  });
  return in_flight;
}

}  // namespace tet4d::qslim4d
