#include "tools/common/memory_sampler.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>

namespace tet4d::cli {

std::uint64_t processMemory(std::string_view field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field) && line.size() > field.size() && line[field.size()] == ':') {
      return std::strtoull(line.c_str() + field.size() + 1, nullptr, 10) * 1024;
    }
  }
  return 0;
}

MemorySampler::MemorySampler()
    : thread_([this](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
          sample();
          wake_.wait_for(lock, stop, std::chrono::milliseconds(5), [] { return false; });
        }
      }) {}

MemorySampler::~MemorySampler() = default;

std::uint64_t MemorySampler::peakBytes() {
  sample();
  return peak_;
}

void MemorySampler::sample() {
  const std::uint64_t now = processMemory("RssAnon");
  std::uint64_t before = peak_;
  while (before < now && !peak_.compare_exchange_weak(before, now)) {
  }
}

}  // namespace tet4d::cli
