// Promises over cells, and what an interrupt leaves of a run with parts and columns.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_bound.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"
#include "tests/qslim4d/cell_scenes.h"

namespace tet4d::qslim4d {
namespace {

namespace marching = hypermesh::testing;
using testing::balls;
using testing::bytesOf;
using testing::expectSound;
using testing::fields;
using testing::inCells;
using testing::open;
using testing::simplifyTo;
using testing::targetsOf;

const std::vector<std::string> kWave{"wave"};

CellPromise promiseOf(const hypermesh::File& file, double world, std::uint64_t tries = 8) {
  CellPromise promise{world, tries, {}};
  promise.confirm = [&file, world](const hypermesh::File& tried, std::size_t part, std::span<const double> broken_at) {
    std::vector<double> frames = measure::framesAndBetween(file);
    for (const double frame : broken_at) {
      const auto at = std::find(frames.begin(), frames.end(), frame);
      if (at != frames.end()) std::rotate(frames.begin(), at, at + 1);
    }
    outofcore::ThreadExecutor executor(2);
    outofcore::Progress progress;
    exchange::SliceWants wants;
    if (!file.parts().empty()) wants.part = part;
    const measure::SliceBound bound =
        measure::boundSlices([&](double frame) { return exchange::sliceHypermesh(tried, frame); },
                             [&](double frame) { return std::move(exchange::sliceHypermesh(file, frame, wants).mesh); },
                             file.header().index_to_world, file.header().domain, frames, world, executor, progress);
    return Confirmation{bound.bound, bound.frame, bound.within};
  };
  return promise;
}

TEST(CellsLoad, APromiseIsKeptOverCellsAndNearlyUsedUp) {
  const std::string in = marching::temporaryPath("load_in.t4h"), out = marching::temporaryPath("load_out.t4h");
  balls(in, true);
  const hypermesh::File file = open(in);
  CellOptions cells = inCells(file.header().tets / 7);
  cells.promise = promiseOf(file, 0.35);
  const CellReport report = simplifyTo(out, file, {}, cells, {2});
  EXPECT_TRUE(report.is_kept);
  EXPECT_GT(report.bound, 0.4 * 0.35);
  EXPECT_LE(report.bound, 0.35);
  EXPECT_LT(report.tets, file.header().tets / 3);
  const hypermesh::File result = open(out);
  expectSound(result);
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  const measure::SliceDistance distance = measure::compareSlices(result, file, measure::framesAndBetween(file),
                                                                 {1e-3, 20'000, 400'000}, executor, progress);
  EXPECT_LE(distance.max, report.bound * (1 + 1e-9));
  float largest = 0;
  for (std::size_t k = 0; k < result.geometryPages(); ++k)
    largest = std::max(largest, result.geometryEntry(k).error_measured);
  EXPECT_FLOAT_EQ(largest, static_cast<float>(report.bound)) << "the page table tells what was measured";
}

TEST(CellsLoad, APromiseThatCannotBeKeptWritesNothing) {
  const std::string in = marching::temporaryPath("load_in.t4h"), out = marching::temporaryPath("load_out.t4h");
  balls(in, false);
  std::filesystem::remove(out);
  const hypermesh::File file = open(in);
  CellOptions cells = inCells(file.header().tets / 4);
  // The first estimate is the promise, which is several times below the largest distance.
  cells.promise = promiseOf(file, 0.02, 1);
  const CellReport report = simplifyTo(out, file, {}, cells, {2});
  EXPECT_FALSE(report.is_kept);
  EXPECT_EQ(report.tries, 1u);
  EXPECT_GT(report.bound, 0.02);
  EXPECT_FALSE(std::filesystem::exists(out));
}

// ---- interrupts

TEST(CellsLoad, InterruptsAtManyStepsAreResumedToTheSameBytes) {
  const std::string in = marching::temporaryPath("load_in.t4h"), out = marching::temporaryPath("load_out.t4h");
  balls(in, true, fields());
  const hypermesh::File file = open(in);
  for (const bool promised : {false, true}) {
    CellOptions cells = inCells(file.header().tets / 5);
    Options options;
    if (promised) {
      cells.promise = promiseOf(file, 0.3, 3);
    } else {
      cells.targets = targetsOf(file, 8);
    }
    simplifyTo(out, file, options, cells, {2}, kWave);
    const std::string bytes = bytesOf(out);
    std::filesystem::remove(out);
    cells.resume = true;
    int interrupts = 0;
    bool whole = false;
    for (int steps = 2; !whole && interrupts < 200; steps += promised ? 11 : 4) {
      testing::Interrupting progress(steps);
      outofcore::ThreadExecutor executor(1);
      outofcore::MemoryBudget memory;
      outofcore::Progress silent;
      std::vector<Column> columns{{"wave", 1}, {"label", 1}, {"holes", 1}};
      cells.folder = out + ".cells", cells.run_name = "test";
      cells.columns = planColumns(file, std::vector<ColumnWish>{{0, true, {}}, {1, false, {}}, {2, false, {}}}, silent);
      hypermesh::Writer writer = testing::writerFor(out, file, columns);
      try {
        simplifyInCells(file, Metric::kSlice, options, cells, writer, executor, memory, progress);
        unwrap(writer.close("{}"));
        whole = true;
      } catch (const Error& error) {
        ASSERT_EQ(error.fault().code, FaultCode::kInterrupted) << error.fault().what;
        ++interrupts;
      }
    }
    EXPECT_TRUE(whole) << promised;
    EXPECT_GT(interrupts, 4);
    EXPECT_TRUE(bytes == bytesOf(out)) << promised;
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
