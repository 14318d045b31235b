// Who runs the tasks. A builder plans tasks from data and options only and hands them to an Executor; the number of
// threads changes the time, never the bytes. Builders start no threads themselves.
#pragma once

#include <cstddef>
#include <functional>

namespace tet4d::outofcore {

class Executor {
 public:
  virtual ~Executor() = default;
  virtual std::size_t threads() const = 0;
  // Calls task(0) … task(count - 1), each once, in any order and on any thread; returns when all are done.
  // The first exception thrown by a task is rethrown here after the others have stopped.
  virtual void run(std::size_t count, const std::function<void(std::size_t)>& task) = 0;
};

// Most threads an executor runs; more are of no use to any builder.
inline constexpr std::size_t kMaxThreads = 256;

// Runs tasks on `threads` threads (0 = one per core, at most kMaxThreads), the caller's among them. A thread is started
// when there is a task for it and lives as long as the executor.
class ThreadExecutor final : public Executor {
 public:
  explicit ThreadExecutor(std::size_t threads);
  ~ThreadExecutor() override;
  std::size_t threads() const override;
  void run(std::size_t count, const std::function<void(std::size_t)>& task) override;

 private:
  struct State;
  State* state_;
};

}  // namespace tet4d::outofcore
