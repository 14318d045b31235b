#include "libpreprocess/qslim4d/simplify.h"

#include "libpreprocess/qslim4d/orders.h"

namespace tet4d::qslim4d {

Stats simplify(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, outofcore::Progress& progress) {
  progress.phase("simplify", mesh.live_tets - std::min(mesh.live_tets, options.target_tets));
  Ledger ledger(mesh, options, progress);
  switch (options.order) {
    case Order::kHeap:
      runHeap(mesh, options, ledger);
      break;
    case Order::kMultichoice:
      runMultichoice(mesh, options, ledger);
      break;
    case Order::kPasses:
      runPasses(mesh, options, executor, ledger);
      break;
  }
  ledger.stats.stalled = !ledger.isDone();
  return ledger.stats;
}

}  // namespace tet4d::qslim4d
