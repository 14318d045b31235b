// Hypermeshes of moving surfaces: manifold, equal to the input at its frames, closed between, as small as motion
// allows.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/hypermesh_measures.h"
#include "libpreprocess/measure/slice_measures.h"
#include "tests/prisms/moving_surfaces.h"

namespace tet4d::testing {
namespace {

using Points = std::vector<std::array<double, 3>>;

// Turns and breathes: nothing is straight.
FormulaSurface turningTorus(std::uint32_t n, std::size_t frames, double turn) {
  return {torusTriangles(n, n), countTo(frames), [=](std::size_t k) {
            Points points = torusPoints(n, n);
            const double a = turn * static_cast<double>(k), grow = 1 + 0.1 * std::sin(0.1 * static_cast<double>(k));
            for (auto& p : points)
              p = {grow * (p[0] * std::cos(a) - p[2] * std::sin(a)), grow * p[1],
                   grow * (p[0] * std::sin(a) + p[2] * std::cos(a))};
            return points;
          }};
}

// Each vertex moves at a speed of its own and never bends.
FormulaSurface shearedTorus(std::uint32_t n, std::size_t frames, double speed) {
  return {torusTriangles(n, n), countTo(frames), [=](std::size_t k) {
            Points points = torusPoints(n, n);
            for (auto& p : points) p[0] += speed * static_cast<double>(k);
            return points;
          }};
}

void expectClosedAtRandomTimes(const hypermesh::File& file, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(0, static_cast<double>(file.header().frames - 1));
  for (int i = 0; i < 12; ++i) {
    const double t = at(random);
    const SliceMesh slice = exchange::sliceHypermesh(file, t);
    const auto measured = measure::measureSlice(slice.positions, slice.triangles);
    EXPECT_TRUE(measured.closed()) << t;
    EXPECT_EQ(measured.euler(), 0) << t;
    EXPECT_GT(measured.volume, 0) << t;
  }
}

TEST(Prisms, EveryFrameKeptIsTheInputAtItsFrames) {
  test::Scratch scratch;
  FormulaSurface source = turningTorus(8, 6, 0.4);
  const Built built = build(scratch, source, {.linear_window = 1});
  EXPECT_EQ(built.stats.tets, 3u * 128 * 5);
  EXPECT_EQ(built.stats.vertices, 64u * 6);
  EXPECT_EQ(built.stats.error_measured, 0);
  EXPECT_EQ(built.file.geometryPages(), 5u);
  EXPECT_EQ(expectManifold(built.file), 0u) << "closed in space";
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(distanceAtFrame(built.file, source, k), 0) << k;
  expectClosedAtRandomTimes(built.file, 1);
  // Slices at frames have the input's volume: orientation and all.
  outofcore::Progress progress;
  const auto measures = measure::measureHypermesh(built.file, progress);
  EXPECT_LT(measures.closure, 1e-6);
}

TEST(Prisms, WhatNeverBendsMakesTheSameFileForAnyWindow) {
  test::Scratch scratch;
  std::vector<std::byte> expected;
  for (const std::uint64_t window : {1U, 3U, 16U, 63U}) {
    FormulaSurface source = turningTorus(6, 20, 0.4);
    const Built built = build(scratch, source, {.linear_window = window});
    EXPECT_EQ(built.stats.tets, built.stats.tets_expanded);
    if (window == 1) expected = test::readBytes(built.path);
    EXPECT_EQ(test::readBytes(built.path), expected) << window;
  }
}

TEST(Prisms, StraightMotionIsNotExpanded) {
  test::Scratch scratch;
  for (const double speed : {0.0, 0.25, 0.1}) {  // 0.1 is rounded in f32
    FormulaSurface source = shearedTorus(6, 33, speed);
    const Built built = build(scratch, source, {.linear_window = 16});
    EXPECT_EQ(built.stats.tets, 3u * 72 * 2) << speed;
    EXPECT_EQ(built.stats.vertices, 36u * 3) << speed;
    EXPECT_LE(built.stats.error_measured, 8 * std::ldexp(1.0, -23) * 2) << speed;
    EXPECT_EQ(expectManifold(built.file), 0u);
    expectClosedAtRandomTimes(built.file, 2);
  }
}

TEST(Prisms, ToleranceIsKeptAtEveryFrameAndPaysOff) {
  test::Scratch scratch;
  std::uint64_t before = std::numeric_limits<std::uint64_t>::max();
  for (const double tolerance : {1e-4, 1e-3, 1e-2, 5e-2}) {
    FormulaSurface source = turningTorus(10, 25, 0.03);
    const Built built = build(scratch, source, {.linear_tolerance = tolerance, .linear_window = 12});
    EXPECT_LE(built.stats.error_measured, tolerance + 1e-5);
    EXPECT_LE(built.stats.tets, before);
    before = built.stats.tets;
    EXPECT_EQ(expectManifold(built.file), 0u);
    expectClosedAtRandomTimes(built.file, 3);
    double worst = 0;
    for (std::size_t k = 0; k < 25; ++k) worst = std::max(worst, distanceAtFrame(built.file, source, k));
    EXPECT_LE(worst, built.stats.error_measured + 1e-5) << "found by trying every triangle";
    float stored = 0;
    for (std::size_t k = 0; k < built.file.geometryPages(); ++k)
      stored = std::max(stored, built.file.geometryEntry(k).error_measured);
    EXPECT_NEAR(stored, built.stats.error_measured, 1e-6 * built.stats.error_measured);
    EXPECT_GE(double{stored}, built.stats.error_measured);
  }
  EXPECT_LT(before, 3u * 200 * 24 / 3) << "a third of what keeping every frame takes";
}

// Half of the torus turns, half stands still: only the still one is left out.
TEST(Prisms, GroupsAreKeptApart) {
  test::Scratch scratch;
  FormulaSurface source(torusTriangles(12, 6), countTo(17), [](std::size_t k) {
    Points points = torusPoints(12, 6);
    for (auto& p : points)
      if (p[0] > 0) p[2] += p[0] * std::sin(0.7 * static_cast<double>(k));
    return points;
  });
  const Built built = build(scratch, source, {});
  EXPECT_EQ(expectManifold(built.file), 0u);
  for (std::size_t k = 0; k < 17; ++k) EXPECT_LE(distanceAtFrame(built.file, source, k), 1e-6) << k;
  EXPECT_LT(built.stats.tets, built.stats.tets_expanded * 3 / 4);
  EXPECT_GT(built.stats.tets, built.stats.tets_expanded / 3);
  expectClosedAtRandomTimes(built.file, 4);
}

TEST(Prisms, AreTheSameForAnyThreads) {
  test::Scratch scratch;
  FormulaSurface source = turningTorus(64, 9, 0.02);  // more than one block of edges and triangles
  const prisms::Options options{.linear_tolerance = 2e-3, .linear_window = 8};
  const auto one = test::readBytes(build(scratch, source, options, 1).path);
  EXPECT_EQ(test::readBytes(build(scratch, source, options, 3).path), one);
  const Built built = build(scratch, source, options, 2);
  EXPECT_LT(built.stats.tets, built.stats.tets_expanded);
}

TEST(Prisms, AToleranceMayBeAPartOfTheDiagonal) {
  test::Scratch scratch;
  FormulaSurface source = turningTorus(6, 5, 0.1);
  const double diagonal = std::sqrt(5.4 * 5.4 + 5.4 * 5.4 + 1.4 * 1.4);
  const Built built = build(scratch, source, {.linear_tolerance = 0.01, .relative = true});
  EXPECT_NEAR(built.stats.tolerance, 0.01 * diagonal, 0.01);
}

TEST(Prisms, TheBudgetIsHeld) {
  test::Scratch scratch;
  FormulaSurface source = turningTorus(16, 9, 0.1);
  const prisms::Options options;
  const prisms::Plan plan = prisms::plan(source, options);
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  for (const std::uint64_t limit : {plan.fixed_bytes - 1, plan.fixed_bytes + plan.most_page_bytes}) {
    hypermesh::Writer writer = unwrap(hypermesh::Writer::create(scratch.path("m.t4h"), prisms::meshHeader(source),
                                                                source.info().times, {}, paged::Codec::kRaw, true));
    outofcore::MemoryBudget memory(limit);
    if (limit < plan.fixed_bytes) {
      EXPECT_THROW(prisms::buildPrisms(source, writer, options, executor, memory, progress), Error);
    } else {
      prisms::buildPrisms(source, writer, options, executor, memory, progress);
      unwrap(writer.close("{}"));
      const auto bytes = test::readBytes(scratch.path("m.t4h")).size();
      EXPECT_GE(bytes, plan.least_output_bytes);
      EXPECT_LE(bytes, plan.most_output_bytes);
    }
  }
}

}  // namespace
}  // namespace tet4d::testing
