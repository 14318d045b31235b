// Times the extraction in memory: frames are read before, pages are dropped. Prints a JSON line a run.
// usage: bench_marching ISO RUNS THREADS [--portable] [--normals tets|gradient] FRAMES...
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"

namespace {

using namespace tet4d;

class Preloaded final : public exchange::FrameSource {
 public:
  explicit Preloaded(exchange::FrameSource& source) : grid_(source.grid()), times_(source.times()) {
    for (std::size_t k = 0; k < times_.size(); ++k) {
      frames_.emplace_back(grid_.frameBytes());
      source.readFrame(k, frames_.back());
    }
  }
  const exchange::GridInfo& grid() const override { return grid_; }
  const std::vector<double>& times() const override { return times_; }
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    const std::uint64_t layer = grid_.layerBytes();
    std::memcpy(samples.data(), frames_[k].data() + z_begin * layer, (z_end - z_begin) * layer);
  }
  std::string frameName(std::size_t k) const override { return "frame " + std::to_string(k); }

 private:
  exchange::GridInfo grid_;
  std::vector<double> times_;
  std::vector<std::vector<std::byte>> frames_;
};

class Dropped final : public hypermesh::PageSink {
 public:
  void add(const hypermesh::Page&) override {}
  void addFlags(std::uint32_t) override {}
  void setTimes(std::span<const double>, float) override {}
};

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

int bench(const std::vector<std::string>& words) {
  hypermesh::Options options;
  options.iso = std::stod(words.at(0));
  const int runs = std::stoi(words.at(1));
  const std::size_t threads = std::stoul(words.at(2));
  std::vector<std::string> inputs;
  for (std::size_t i = 3; i < words.size(); ++i) {
    if (words[i] == "--portable") {
      options.simd = hypermesh::Simd::kPortable;
    } else if (words[i] == "--normals") {
      options.normals = words.at(++i) == "tets" ? hypermesh::Normals::kTets : hypermesh::Normals::kGradient;
    } else {
      inputs.push_back(words[i]);
    }
  }
  Preloaded source(*exchange::openFrames(inputs));
  for (int run = 0; run < runs; ++run) {
    Dropped sink;
    outofcore::ThreadExecutor executor(threads);
    outofcore::MemoryBudget memory;
    outofcore::Progress progress;
    const double begin = seconds();
    const std::clock_t cpu = std::clock();
    const hypermesh::Stats stats = hypermesh::buildHypermesh(source, sink, options, executor, memory, progress);
    const double wall = seconds() - begin, cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
    std::printf(
        "{\"threads\": %zu, \"tets\": %llu, \"samples\": %llu, \"seconds_wall\": %.6f, \"seconds_cpu\": %.6f, "
        "\"tets_per_s\": %.0f, \"samples_per_s\": %.0f}\n",
        threads, static_cast<unsigned long long>(stats.tets), static_cast<unsigned long long>(stats.voxels), wall,
        cpu_s, static_cast<double>(stats.tets) / wall, static_cast<double>(stats.voxels) / wall);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) return std::fputs("usage: bench_marching ISO RUNS THREADS [--portable] FRAMES...\n", stderr), 2;
  try {
    return bench({argv + 1, argv + argc});
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_marching: %s: %s\n", error.fault().file.c_str(), error.fault().what.c_str());
    return 1;
  }
}
