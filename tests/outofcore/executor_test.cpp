#include "libpreprocess/outofcore/executor.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <iterator>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace tet4d::outofcore {
namespace {

class ExecutorTest : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ExecutorTest, EveryTaskRunsOnce) {
  ThreadExecutor executor(GetParam());
  EXPECT_EQ(executor.threads(), GetParam());
  for (const std::size_t count : {0U, 1U, 2U, 7U, 1000U}) {
    std::vector<std::atomic<int>> runs(count);
    executor.run(count, [&](std::size_t i) { ++runs.at(i); });
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(runs[i], 1) << "task " << i << " of " << count;
  }
}

TEST_P(ExecutorTest, ManyRoundsLeaveNothingBehind) {
  ThreadExecutor executor(GetParam());
  std::atomic<std::uint64_t> sum{0};
  for (int round = 0; round < 2000; ++round) executor.run(3, [&](std::size_t i) { sum += i + 1; });
  EXPECT_EQ(sum, 2000u * 6u);
}

TEST_P(ExecutorTest, TheFirstExceptionIsRethrownAndTheRestIsSkipped) {
  ThreadExecutor executor(GetParam());
  constexpr std::size_t kTasks = 1'000'000;
  std::atomic<std::size_t> runs{0};
  const auto task = [&](std::size_t) {
    ++runs;
    throw std::runtime_error("task failed");
  };
  EXPECT_THROW(executor.run(kTasks, task), std::runtime_error);
  EXPECT_LE(runs, GetParam());
  std::atomic<std::size_t> later{0};
  executor.run(10, [&](std::size_t) { ++later; });
  EXPECT_EQ(later, 10u);
}

TEST_P(ExecutorTest, ATaskMayRunTasks) {
  ThreadExecutor executor(GetParam());
  std::atomic<int> runs{0};
  executor.run(4, [&](std::size_t) { executor.run(5, [&](std::size_t) { ++runs; }); });
  EXPECT_EQ(runs, 20);
}

// After nested tasks the thread is still inside its own: the next nested run must not wait for the pool either.
TEST_P(ExecutorTest, ATaskMayRunTasksTwice) {
  ThreadExecutor executor(GetParam());
  std::atomic<int> runs{0};
  executor.run(4, [&](std::size_t) {
    for (int twice = 0; twice < 2; ++twice) executor.run(5, [&](std::size_t) { ++runs; });
  });
  EXPECT_EQ(runs, 40);
}

INSTANTIATE_TEST_SUITE_P(Threads, ExecutorTest, ::testing::Values(1, 2, 5));

TEST(ThreadExecutorTest, WorkIsShared) {
  ThreadExecutor executor(2);
  std::atomic<int> arrived{0};
  std::vector<std::thread::id> ids(2);
  // Both tasks wait for each other: this ends only if two threads run them.
  executor.run(2, [&](std::size_t i) {
    ids[i] = std::this_thread::get_id();
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_NE(ids[0], ids[1]);
}

TEST(ThreadExecutorTest, ZeroMeansOneThreadPerCore) { EXPECT_GE(ThreadExecutor(0).threads(), 1u); }

// No more threads than kMaxThreads, and none without a task for it.
TEST(ExecutorLimitTest, ThreadsAreStartedForTasks) {
  const auto threadsOfProcess = [] {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  std::thread([] {}).join();  // with the first thread the thread sanitizer starts one of its own
  const auto before = threadsOfProcess();
  ThreadExecutor executor(100'000);
  EXPECT_EQ(executor.threads(), kMaxThreads);
  EXPECT_EQ(threadsOfProcess(), before);
  std::atomic<int> runs{0};
  for (const std::size_t count : {3U, 2U, 5U, 4U}) executor.run(count, [&](std::size_t) { ++runs; });
  EXPECT_EQ(runs, 14);
  EXPECT_EQ(threadsOfProcess(), before + 4);
}

}  // namespace
}  // namespace tet4d::outofcore
