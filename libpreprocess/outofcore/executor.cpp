#include "libpreprocess/outofcore/executor.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace tet4d::outofcore {

namespace {
// A task that calls run() again gets its tasks done on its own thread: waiting for the pool from inside it would hang.
thread_local bool inside_task = false;
}  // namespace

struct ThreadExecutor::State {
  std::atomic<std::size_t> limit{1};  // threads, the caller's included
  std::vector<std::thread> workers;   // grows under run_mutex
  std::mutex run_mutex;               // one run() at a time

  std::mutex mutex;
  std::condition_variable begin, end;
  std::uint64_t round = 0;  // raised once for every run()
  std::size_t busy = 0;     // workers that have not finished the round
  bool stopping = false;

  const std::function<void(std::size_t)>* task = nullptr;
  std::size_t count = 0;
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;

  // Until there are `wanted`, or as many as the system grants: those do the work, with the same result.
  void startWorkers(std::size_t wanted) {
    try {
      while (workers.size() < wanted) workers.emplace_back([this, before = round] { work(before); });
    } catch (const std::system_error&) {
      limit = workers.size() + 1;
    }
  }

  // Takes tasks until none is left or one has failed.
  void drain() {
    inside_task = true;
    for (std::size_t i = next++; i < count && !failed; i = next++) {
      try {
        (*task)(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failed.exchange(true)) failure = std::current_exception();
      }
    }
    inside_task = false;
  }

  // `seen` is the round before the worker's first one.
  void work(std::uint64_t seen) {
    std::unique_lock lock(mutex);
    while (true) {
      begin.wait(lock, [&] { return stopping || round != seen; });
      if (stopping) return;
      seen = round;
      lock.unlock();
      drain();
      lock.lock();
      if (--busy == 0) end.notify_all();
    }
  }
};

ThreadExecutor::ThreadExecutor(std::size_t threads) : state_(new State) {
  if (threads == 0) threads = std::max<std::size_t>(1, std::thread::hardware_concurrency());
  state_->limit = std::min(threads, kMaxThreads);
}

ThreadExecutor::~ThreadExecutor() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
  }
  state_->begin.notify_all();
  for (std::thread& worker : state_->workers) worker.join();
  delete state_;
}

std::size_t ThreadExecutor::threads() const { return state_->limit; }

void ThreadExecutor::run(std::size_t count, const std::function<void(std::size_t)>& task) {
  if (inside_task || count <= 1 || state_->limit == 1) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return;
  }
  const std::lock_guard one_run(state_->run_mutex);
  state_->startWorkers(std::min<std::size_t>(state_->limit, count) - 1);
  {
    const std::lock_guard lock(state_->mutex);
    state_->task = &task;
    state_->count = count;
    state_->next = 0;
    state_->failed = false;
    state_->failure = nullptr;
    state_->busy = state_->workers.size();
    ++state_->round;
  }
  state_->begin.notify_all();
  state_->drain();
  std::unique_lock lock(state_->mutex);
  state_->end.wait(lock, [&] { return state_->busy == 0; });
  if (state_->failure) std::rethrow_exception(std::exchange(state_->failure, nullptr));
}

}  // namespace tet4d::outofcore
