#include "libpreprocess/outofcore/progress.h"

#include <gtest/gtest.h>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {
namespace {

// In a process of its own: an interrupt is for good.
TEST(ProgressDeathTest, AStepNoticesAnInterrupt) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto interruptedRun = [] {
    Progress progress;
    progress.phase("read", 2);
    progress.step(1);
    requestInterrupt();
    try {
      progress.step(2);
    } catch (const Error& error) {
      std::exit(error.fault().code == FaultCode::kInterrupted && interruptRequested() ? 7 : 1);
    }
    std::exit(0);
  };
  EXPECT_EXIT(interruptedRun(), ::testing::ExitedWithCode(7), "");
  EXPECT_FALSE(interruptRequested());
}

}  // namespace
}  // namespace tet4d::outofcore
