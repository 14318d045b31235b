// The peak of a program's anonymous memory. The system keeps a high-water mark of all resident memory only, mapped
// files included, so a thread looks at the anonymous part while the program runs.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <thread>

namespace tet4d::cli {

// A field of /proc/self/status in bytes ("VmHWM", "RssAnon"); 0 where the system has none.
std::uint64_t processMemory(std::string_view field);

class MemorySampler {
 public:
  MemorySampler();
  ~MemorySampler();
  MemorySampler(const MemorySampler&) = delete;
  MemorySampler& operator=(const MemorySampler&) = delete;

  // The largest value seen so far, this moment included; peaks shorter than 5 ms may be missed.
  std::uint64_t peakBytes();

 private:
  void sample();

  std::atomic<std::uint64_t> peak_{0};
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace tet4d::cli
