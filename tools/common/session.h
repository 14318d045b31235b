// What a program's body gets from run(): the values of the common options, an executor, progress, the record of
// --stats.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::cli {

class Command;

// Values of the common options; those a program did not enlist keep their defaults.
struct CommonOptions {
  std::string output;              // -o; "-" is standard output; empty if not given
  std::uint64_t threads = 0;       // -j; 0 = one per core
  std::uint64_t memory_bytes = 0;  // --memory; 0 = no limit
  std::string temp_dir;            // --temp-dir; empty = beside the output
  bool force = false;              // -f
  bool dry_run = false;            // -n
  bool resume = false;             // --resume
  std::uint64_t seed = 0;          // --seed
  bool quiet = false;              // -q
  bool verbose = false;            // -v
  std::string progress = "auto";   // --progress auto|bar|plain|json|none
  std::string stats;               // --stats
  std::string depfile;             // --depfile
  std::string config;              // --config
};

// What --stats records beyond times and memory.
class Stats {
 public:
  struct Frame {
    double time = 0;                  // world time of the picture
    double ms = 0;                    // to draw it
    std::uint64_t drawn = 0;          // triangles alive at `time`
    std::uint64_t processed = 0;      // triangles given to the GPU or the slicer
    std::uint64_t bytes_touched = 0;  // stored bytes of pages used for the first time since they were read
    std::uint64_t prefetched = 0;     // of them, what had come before it was needed
    std::uint64_t absent = 0;         // pages that should be drawn and were not there
    double load_ms = 0, choose_ms = 0, draw_ms = 0;  // parts of ms: pages, triangles, drawing and reading back
    double samples = 0;                              // a pixel
  };
  // Counts are named by what they count: vertices, tets, triangles, patches, nodes, leaves, points, voxels, frames.
  void count(const std::string& name, std::uint64_t value);
  void error(const std::string& name, double value);
  void frame(const Frame& frame) { frames_.push_back(frame), has_frames_ = true; }
  // The player calls it so that "frames" is there even if none was drawn.
  void expectFrames() { has_frames_ = true; }

  const std::vector<std::pair<std::string, std::uint64_t>>& counts() const { return counts_; }
  const std::vector<std::pair<std::string, double>>& errors() const { return errors_; }
  const std::vector<Frame>& frames() const { return frames_; }
  bool hasFrames() const { return has_frames_; }

 private:
  std::vector<std::pair<std::string, std::uint64_t>> counts_;
  std::vector<std::pair<std::string, double>> errors_;
  std::vector<Frame> frames_;
  bool has_frames_ = false;
};

// One input for provenance: its name (directories are dropped) and a digest of its content, as hexadecimal text.
struct Input {
  std::string path, digest;
};

class Session {
 public:
  explicit Session(const Command& command);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const std::string& program() const;
  const CommonOptions& options() const;
  outofcore::Executor& executor();  // started at first use, with -j threads
  outofcore::Progress& progress();
  outofcore::MemoryBudget& memory();
  Stats& stats();

  // Lines on stderr: `program: text`. note() is silent under -q, detail() unless -v; warn() is never silent.
  void note(std::string_view text);
  void detail(std::string_view text);
  void warn(std::string_view text);

  // Files the output depends on, for --depfile; in the order given.
  void dependsOn(const std::string& path);
  // Provenance of an output: {"program", "version", "options": those that change the result, "inputs"}. The same text
  // for any thread count, machine, directory or time.
  std::string provenance(std::span<const Input> inputs) const;

  // Ends the progress display and writes --stats and --depfile; run() calls it.
  void finish();
  // Ends the display only, so that an error stands on a clean line.
  void stopProgress();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// XXH3-64 of a file's content as 16 hexadecimal digits, for provenance. Throws Error{kIo}. O(bytes).
std::string fileDigest(const std::string& path);

}  // namespace tet4d::cli
