// Where the values of a file's columns lie, found out by a thread behind; asked for from the drawing thread.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "player/scene/column_spread.h"

namespace tet4d::host {

class ColumnScans {
 public:
  // `file` must outlive it.
  explicit ColumnScans(const dyntri::File& file) : file_(file) {}
  ~ColumnScans();
  ColumnScans(const ColumnScans&) = delete;
  ColumnScans& operator=(const ColumnScans&) = delete;

  // Null until it is known; asks for it the first time, those asked for last first. Stays where it is. A column that
  // cannot be read is known as a spread without values.
  const scene::ColumnSpread* of(std::size_t column, int component);
  // What is known, without asking.
  const scene::ColumnSpread* known(std::size_t column, int component) const;
  // The same, waiting for it.
  const scene::ColumnSpread& wait(std::size_t column, int component);
  bool busy() const;
  std::size_t done() const;                                // columns known so far
  std::uint64_t bytesRead() const { return bytes_read_; }  // of the file, as they are stored there
  // Columns that could not be read, each once.
  std::vector<Fault> takeFaults();

 private:
  using Which = std::pair<std::size_t, int>;
  void ask(const Which& which);
  void run(const std::stop_token& stop);

  const dyntri::File& file_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::map<Which, std::optional<scene::ColumnSpread>> spreads_;  // asked for; entries stay where they are
  std::vector<Which> queue_;                                     // last first
  std::vector<Fault> faults_;
  bool reading_ = false;
  std::size_t done_ = 0;
  std::atomic<std::uint64_t> bytes_read_ = 0;
  std::jthread thread_;  // last: stops before the rest goes
};

}  // namespace tet4d::host
