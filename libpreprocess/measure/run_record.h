// The record of a run: what a program's --stats wrote (docs/benchmarks/README.md), as numbers.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tet4d::measure {

struct RunRecord {
  struct Phase {
    std::string name;
    double seconds_wall = 0, seconds_cpu = 0;
  };
  struct Frame {
    double time = 0, ms = 0;
    std::uint64_t drawn = 0, processed = 0, bytes_touched = 0;
  };
  std::string program, version;
  std::map<std::string, std::uint64_t> counts;
  std::map<std::string, double> errors;
  double seconds_wall = 0, seconds_cpu = 0;
  std::uint64_t peak_bytes = 0, anonymous_bytes = 0, threads = 0;
  std::vector<Phase> phases;
  std::vector<Frame> frames;

  // The count or 0; the seconds of the phase or 0.
  std::uint64_t count(const std::string& name) const;
  double phaseSeconds(const std::string& name) const;
};

// Reads a file that --stats wrote; fields it does not know are passed over, so that newer programs can be read. Throws
// Error: kIo if it cannot be read, kBadInput naming the field that is missing or of another type.
RunRecord readRunRecord(const std::string& path);

// The value at `share` (0 … 1) of the sorted values, the lower of two neighbours; 0 of none. NaN is not allowed.
double percentile(std::vector<double> values, double share);

}  // namespace tet4d::measure
