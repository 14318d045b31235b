// The promise: the search on functions that are known, the bound on surfaces that are, and both on a mesh.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_bound.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/qslim4d/packed_mesh.h"
#include "libpreprocess/qslim4d/promise.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/qslim4d/closed_slices.h"

namespace tet4d::qslim4d {
namespace {

namespace marching = hypermesh::testing;

TEST(Promise, IsKeptAndNearlyUsedUp) {
  for (const double factor : {0.05, 0.7, 3.0, 40.0, 1e6}) {
    for (const double power : {0.5, 1.0, 2.0}) {
      const auto measured = [&](double estimate) { return factor * std::pow(estimate, power); };
      std::vector<double> kept;
      const PromiseOutcome outcome = keepPromise(0.25, 40, [&](double estimate) {
        const double m = measured(estimate);
        if (m <= 0.25) kept.push_back(estimate);
        return Attempt{m, m <= 0.25, false};
      });
      EXPECT_TRUE(outcome.kept);
      EXPECT_LE(outcome.measured, 0.25);
      EXPECT_GT(outcome.measured, 0.25 * 0.6) << factor << " " << power;
      EXPECT_EQ(outcome.estimate, kept.back());
      EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end())) << "the last one kept is the best";
      EXPECT_LE(outcome.tries, 16u);
    }
  }
}

TEST(Promise, IsConfirmedWhateverTheMeasureDoes) {
  std::uint64_t state = 1;
  for (int i = 0; i < 200; ++i) {
    double last_kept = -1;
    const PromiseOutcome outcome = keepPromise(1, 8, [&](double estimate) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      const double m = estimate * 8 * static_cast<double>(state >> 40) / 0x1p24;
      if (m <= 1) last_kept = m;
      return Attempt{m, m <= 1, false};
    });
    EXPECT_LE(outcome.tries, 8u);
    EXPECT_EQ(outcome.kept, last_kept >= 0);
    if (outcome.kept) {
      EXPECT_EQ(outcome.measured, last_kept);
    }
  }
}

TEST(PromiseStiff, WhatCannotBeKeptEndsAndSaysHowFarItCame) {
  const PromiseOutcome outcome = keepPromise(1e-12, 5, [](double estimate) {
    return Attempt{0.1 + estimate, false, false};
  });
  EXPECT_FALSE(outcome.kept);
  EXPECT_EQ(outcome.tries, 5u);
  EXPECT_NEAR(outcome.measured, 0.1, 1e-9);
  const PromiseOutcome infinite = keepPromise(1, 3, [](double) {
    return Attempt{std::numeric_limits<double>::infinity(), false, false};
  });
  EXPECT_FALSE(infinite.kept);
  EXPECT_EQ(infinite.tries, 3u);
}

TEST(Promise, EndsWhereItIsEnough) {
  const PromiseOutcome outcome = keepPromise(1, 8, [](double) { return Attempt{0.01, true, true}; });
  EXPECT_TRUE(outcome.kept);
  EXPECT_EQ(outcome.tries, 1u);
}

// A ball, and beside it a speck that is there in one frame only.
marching::ExtractedMesh ballAndSpeck(const std::string& path) {
  marching::MemoryFrames<float> frames({26, 14, 14}, 6, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    const double ball = 4.3 - std::hypot(f(x) - 6.4 - 0.3 * f(k), f(y) - 6.5, f(z) - 6.6);
    const double speck = (k == 3 ? 1.4 : -1.0) - std::hypot(f(x) - 20.2, f(y) - 6.1, f(z) - 6.3);
    return static_cast<float>(std::max(ball, speck));
  });
  hypermesh::Options options;
  options.iso = 0;
  return marching::extractTo(path, frames, options);
}

TEST(SliceBound, OfAShiftedMeshIsTheShift) {
  const std::string path = marching::temporaryPath("bound_shift.t4h");
  const marching::ExtractedMesh mesh = ballAndSpeck(path);
  const hypermesh::File file = std::move(hypermesh::File::open(path)).value();
  SlimMesh shifted = makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, {}, Metric::kSlice);
  for (Vec4f& v : shifted.positions) v.y += 0.25F;
  std::vector<double> frames = measure::framesAndBetween(file);
  EXPECT_EQ(frames.size(), 11u) << "six frames and five times between";
  EXPECT_EQ(frames.front(), 0);
  EXPECT_EQ(frames.back(), 5);
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  const auto bound = [&](double limit) {
    return measure::boundSlices(
        [&](double frame) { return testing::sliceOf(shifted, mesh.header.domain, static_cast<float>(frame)); },
        [&](double frame) { return exchange::sliceHypermesh(file, frame); }, {}, mesh.header.domain, frames, limit,
        executor, progress);
  };
  const measure::SliceBound kept = bound(0.3);
  EXPECT_TRUE(kept.within);
  EXPECT_GE(kept.bound, 0.24) << "a facet's distance is at most the shift, at the poles it is";
  EXPECT_LE(kept.bound, 0.25 + 0.3 / 50);
  const measure::SliceBound broken = bound(0.2);
  EXPECT_FALSE(broken.within);
  EXPECT_GT(broken.bound, 0.2);
  EXPECT_EQ(frames.front(), broken.frame) << "the time that broke it is asked first next time";
}

TEST(SliceBound, AComponentThatIsMissingIsFarOrInfinitelyFar) {
  const std::string path = marching::temporaryPath("bound_missing.t4h");
  const marching::ExtractedMesh mesh = ballAndSpeck(path);
  const hypermesh::File file = std::move(hypermesh::File::open(path)).value();
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  for (const bool any : {true, false}) {
    std::vector<double> frames{3};
    const auto part = [&](double frame) {
      std::vector<hypermesh::Tet> tets;
      for (const hypermesh::Tet& tet : mesh.tets)
        if (any && mesh.vertices[tet[0]].x < 16) tets.push_back(tet);
      SliceMesh slice;
      sliceTets(tets, mesh.vertices, {}, static_cast<float>(frame), 5, slice);
      return slice;
    };
    const measure::SliceBound bound = measure::boundSlices(
        part, [&](double frame) { return exchange::sliceHypermesh(file, frame); }, {}, mesh.header.domain, frames, 1,
        executor, progress);
    EXPECT_FALSE(bound.within);
    EXPECT_GT(bound.bound, 5);
    EXPECT_EQ(std::isinf(bound.bound), !any);
  }
}

// As the program does it; judged by the other measure, and by what was born.
TEST(Promise, OnAMeshIsKeptAtEveryTimeMeasuredAndBirthsAreKept) {
  const std::string path = marching::temporaryPath("promise_in.t4h"), out = marching::temporaryPath("promise_out.t4h");
  const marching::ExtractedMesh mesh = ballAndSpeck(path);
  const hypermesh::File file = std::move(hypermesh::File::open(path)).value();
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  std::uint64_t left = mesh.tets.size();
  for (const double promised : {0.15, 0.6}) {
    std::vector<double> frames = measure::framesAndBetween(file);
    PackedMesh best;
    const PromiseOutcome outcome = keepPromise(promised, 8, [&](double estimate) {
      SlimMesh slim = makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, {}, Metric::kSlice);
      Options options;
      options.most_error = estimate;
      simplify(slim, options, executor, progress);
      PackedMesh packed = pack(slim);
      const measure::SliceBound bound = measure::boundSlices(
          [&](double frame) { return testing::sliceOf(slim, mesh.header.domain, static_cast<float>(frame)); },
          [&](double frame) { return exchange::sliceHypermesh(file, frame); }, {}, mesh.header.domain, frames, promised,
          executor, progress);
      if (bound.within) best = std::move(packed);
      return Attempt{bound.bound, bound.within, false};
    });
    ASSERT_TRUE(outcome.kept) << promised;
    EXPECT_GT(outcome.measured, 0.3 * promised) << "most of it is used";
    EXPECT_LT(best.tets.size(), left / 2);
    left = best.tets.size();
    auto writer = hypermesh::Writer::create(out, mesh.header, mesh.times, {}, paged::Codec::kRaw, true);
    ASSERT_TRUE(writer.ok());
    writeMeshes({&best, 1}, writer.value(), progress);
    ASSERT_TRUE(writer.value().close("{}").ok());
    const hypermesh::File result = std::move(hypermesh::File::open(out)).value();
    const measure::SliceDistance distance = measure::compareSlices(result, file, measure::framesAndBetween(file),
                                                                   {1e-3, 20'000, 400'000}, executor, progress);
    EXPECT_LE(distance.max, outcome.measured * (1 + 1e-9)) << promised;
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(testing::componentsOf(exchange::sliceHypermesh(result, k)),
                testing::componentsOf(exchange::sliceHypermesh(file, k)))
          << promised << " frame " << k;
    }
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
