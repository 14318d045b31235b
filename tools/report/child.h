// Programs run as child processes, as a user would run them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libpreprocess/measure/run_record.h"

namespace tet4d::report {

struct ChildRun {
  int exit_code = 0;   // 128 + the signal that ended it; 127 if it could not be started
  std::string output;  // standard output, its first 64 KiB
  std::string fault;   // what it said last on standard error, or why it did not run; empty if exit_code is 0
  double seconds_wall = 0, seconds_cpu = 0;
  std::uint64_t peak_bytes = 0;
  std::optional<measure::RunRecord> record;  // of its --stats
};

// The folder of this program, where the others are looked for; "" where the system does not tell.
std::string ownFolder();

class Programs {
 public:
  // bin: the folder of the programs; "" for those that PATH finds. work: an existing
  // folder, absolute: programs run in it, and what they print goes there.
  Programs(std::string bin, std::string work) : bin_(std::move(bin)), work_(std::move(work)) {}

  // Runs a program to its end and reads `stats` if that was written by it. Never throws for what the program does: a
  // failure is in the result. Throws Error{kInterrupted} once this program was asked to stop, which ends the child.
  ChildRun run(const std::string& program, const std::vector<std::string>& arguments,
               const std::string& stats = {}) const;
  // The median by wall seconds of `repeat` runs; the first one that failed.
  ChildRun median(const std::string& program, const std::vector<std::string>& arguments, const std::string& stats,
                  std::uint64_t repeat) const;
  const std::string& work() const { return work_; }

 private:
  std::string bin_, work_;
};

}  // namespace tet4d::report
