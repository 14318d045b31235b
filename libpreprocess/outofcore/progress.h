// Progress as a builder reports it, and the place where an interrupt is noticed.
#pragma once

#include <cstdint>
#include <string_view>

namespace tet4d::outofcore {

// A builder calls step() between tasks. The tools' implementation draws a bar or prints lines
// (tools/common/progress.h); the base class only notices interrupts.
class Progress {
 public:
  virtual ~Progress() = default;
  // A new phase of `total` steps begins ("read", "extract", "write", "measure", …). Times are kept per phase name.
  virtual void phase(std::string_view name, std::uint64_t total) { (void)name, (void)total; }
  // `done` steps of the phase are finished. Throws Error{kInterrupted} after SIGINT, SIGTERM or SIGHUP.
  virtual void step(std::uint64_t done);
};

// Set by the tools' signal handler; async-signal-safe.
void requestInterrupt() noexcept;
bool interruptRequested() noexcept;

}  // namespace tet4d::outofcore
