#include "libpreprocess/outofcore/memory_budget.h"

#include <gtest/gtest.h>

#include <limits>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {
namespace {

TEST(MemoryBudgetTest, ReservationsAddUpAndAreGivenBack) {
  MemoryBudget budget(1000);
  {
    const auto first = budget.reserve(600, "the vertices");
    EXPECT_EQ(budget.used(), 600u);
    EXPECT_EQ(budget.available(), 400u);
    auto second = budget.reserve(400, "the edges");
    second = MemoryBudget::Reservation();
    EXPECT_EQ(budget.used(), 600u);
  }
  EXPECT_EQ(budget.used(), 0u);
  EXPECT_EQ(budget.peak(), 1000u);
}

TEST(MemoryBudgetTest, ARefusalNamesWhatHowMuchAndTheRemedy) {
  MemoryBudget budget(10 << 20);
  const auto held = budget.reserve(8 << 20, "two frames");
  try {
    const auto more = budget.reserve(3 << 20, "the edge table");
    FAIL() << "3 MiB must not fit into 2 MiB";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kOutOfMemory);
    for (const char* part : {"the edge table", "3.0 MiB", "8.0 MiB", "10.0 MiB"}) {
      EXPECT_NE(error.fault().what.find(part), std::string::npos) << part << " in: " << error.fault().what;
    }
    EXPECT_NE(error.fault().remedy.find("--memory 12M"), std::string::npos) << error.fault().remedy;
  }
  EXPECT_EQ(budget.used(), 8u << 20) << "a refusal must not count";
}

TEST(MemoryBudgetTest, NoLimitOnlyCounts) {
  MemoryBudget budget;
  const auto held = budget.reserve(std::uint64_t{1} << 50, "everything");
  EXPECT_EQ(budget.peak(), std::uint64_t{1} << 50);
  EXPECT_EQ(budget.available(), std::numeric_limits<std::uint64_t>::max());
}

TEST(MemoryBudgetTest, SumsThatOverflowAreRefused) {
  MemoryBudget budget(1000);
  const auto held = budget.reserve(10, "a little");
  EXPECT_THROW((void)budget.reserve(std::numeric_limits<std::uint64_t>::max(), "too much"), Error);
}

TEST(MemoryBudgetTest, BytesAsText) {
  EXPECT_EQ(bytesText(0), "0 B");
  EXPECT_EQ(bytesText(1023), "1023 B");
  EXPECT_EQ(bytesText(1536), "1.5 KiB");
  EXPECT_EQ(bytesText(std::uint64_t{3} << 30), "3.0 GiB");
}

}  // namespace
}  // namespace tet4d::outofcore
