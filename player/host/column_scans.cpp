#include "player/host/column_scans.h"

#include <utility>

namespace tet4d::host {

ColumnScans::~ColumnScans() {
  thread_.request_stop();
  changed_.notify_all();
}

const scene::ColumnSpread* ColumnScans::of(std::size_t column, int component) {
  ask({column, component});
  return known(column, component);
}

const scene::ColumnSpread* ColumnScans::known(std::size_t column, int component) const {
  const std::scoped_lock lock(mutex_);
  const auto at = spreads_.find({column, component});
  return at != spreads_.end() && at->second ? &*at->second : nullptr;
}

const scene::ColumnSpread& ColumnScans::wait(std::size_t column, int component) {
  const Which which{column, component};
  ask(which);
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return spreads_[which].has_value(); });
  return *spreads_[which];
}

bool ColumnScans::busy() const {
  const std::scoped_lock lock(mutex_);
  return reading_ || !queue_.empty();
}

std::size_t ColumnScans::done() const {
  const std::scoped_lock lock(mutex_);
  return done_;
}

std::vector<Fault> ColumnScans::takeFaults() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(faults_, {});
}

void ColumnScans::ask(const Which& which) {
  const std::scoped_lock lock(mutex_);
  if (!spreads_.try_emplace(which).second) return;
  queue_.push_back(which);
  if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  changed_.notify_all();
}

void ColumnScans::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return !queue_.empty(); })) {
    const Which which = queue_.back();
    queue_.pop_back();
    reading_ = true;
    lock.unlock();
    const auto count = [&](std::size_t pages_read, std::size_t) {
      bytes_read_ += file_.pages().entries()[file_.tablePage(pages_read - 1) + 1 + which.first].bytes;
      return !stop.stop_requested();
    };
    auto spread = scene::spreadOf(file_, which.first, which.second, count);
    lock.lock();
    reading_ = false;
    ++done_;
    if (stop.stop_requested()) return;
    if (!spread.ok()) faults_.push_back(spread.fault());
    spreads_[which] = spread.ok() ? spread.value() : scene::ColumnSpread{};
    changed_.notify_all();
  }
}

}  // namespace tet4d::host
