// Progress on stderr, and the record of phases for --stats. Private to tools/common.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "libpreprocess/outofcore/progress.h"

namespace tet4d::cli {

struct PhaseTimes {
  std::string name;
  double seconds_wall = 0, seconds_cpu = 0;
};

double processCpuSeconds();

// Thread-safe: tasks may report steps.
class ConsoleProgress final : public outofcore::Progress {
 public:
  enum class Look { kNone, kBar, kPlain, kJson };

  ConsoleProgress(std::string program, Look look);

  void phase(std::string_view name, std::uint64_t total) override;
  void step(std::uint64_t done) override;

  // Ends the phase and wipes the bar; with `summary`, one line says what took how long.
  void finish(bool summary);
  // Makes room for another line on stderr.
  void clearLine();

  // Phases that have ended, in order of their first beginning; the same name twice adds up.
  const std::vector<PhaseTimes>& phases() const { return phases_; }

 private:
  using Clock = std::chrono::steady_clock;

  void endPhase();
  void show(std::uint64_t done);
  void drawBar(double part);
  double secondsInPhase() const;

  std::mutex mutex_;
  const std::string program_;
  const Look look_;
  std::vector<PhaseTimes> phases_;
  std::size_t current_ = 0;  // in phases_, while in_phase_
  bool in_phase_ = false, finished_ = false;
  std::uint64_t total_ = 0, done_ = 0;
  Clock::time_point phase_begin_, last_shown_;
  double phase_cpu_begin_ = 0;
  std::uint64_t shown_percent_ = 0;
  bool bar_on_screen_ = false;
};

}  // namespace tet4d::cli
