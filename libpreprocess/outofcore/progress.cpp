#include "libpreprocess/outofcore/progress.h"

#include <atomic>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {

namespace {
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");
}  // namespace

void requestInterrupt() noexcept { interrupted = true; }
bool interruptRequested() noexcept { return interrupted; }

void Progress::step(std::uint64_t) {
  if (interruptRequested()) throw Error(FaultCode::kInterrupted, {}, {}, "interrupted; nothing was left half-written");
}

}  // namespace tet4d::outofcore
