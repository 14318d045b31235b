// Marching hypercubes against balls with known measures: errors below 1 % at 64^3 x 32, second order in the grid step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "formats/core/slicer.h"
#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"
#include "libpreprocess/measure/hypermesh_measures.h"
#include "libpreprocess/measure/slice_measures.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"
#include "tests/measure/sphere.h"
#include "tests/topology/space_time_meshes.h"

namespace tet4d {
namespace {

using testing::MovingBall;

class BallFrames final : public exchange::FrameSource {
 public:
  BallFrames(const MovingBall& ball, std::uint64_t size, std::size_t frames) : ball_(ball) {
    grid_.dims = {size, size, size};
    for (std::size_t k = 0; k < frames; ++k) times_.push_back(static_cast<double>(k));
  }
  const exchange::GridInfo& grid() const override { return grid_; }
  const std::vector<double>& times() const override { return times_; }
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    auto* out = reinterpret_cast<float*>(samples.data());
    const std::uint64_t n = grid_.dims[0];
    for (std::uint64_t i = z_begin * n * n; i < z_end * n * n; ++i) {
      const auto x = static_cast<double>(i % n), y = static_cast<double>(i / n % n), z = static_cast<double>(i / n / n);
      *out++ = static_cast<float>(ball_.fieldAt(x, y, z, static_cast<double>(k)));
    }
  }
  std::string frameName(std::size_t k) const override { return "ball frame " + std::to_string(k); }

 private:
  MovingBall ball_;
  exchange::GridInfo grid_;
  std::vector<double> times_;
};

// The same shape on every grid: half the size is twice the grid step in space and time, at the same speed.
MovingBall ballOf(double size, const std::array<double, 3>& velocity, double growth) {
  return {{0.40 * size + 0.137, 0.45 * size - 0.291, 0.55 * size + 0.083}, velocity, 0.27 * size, growth};
}

using Errors = std::map<std::string, double>;

struct Outcome {
  Errors errors;  // relative
  double volume3 = 0, tets_per_active_cell = 0;
};

void measureSlices(const hypermesh::File& file, const MovingBall& ball, Errors& errors) {
  std::vector<Vec4f> positions(file.header().vertices);
  std::vector<hypermesh::Tet> tets;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const auto page = unwrap(file.gather(k));
    std::copy(page.view.vertices.begin(), page.view.vertices.end(),
              positions.begin() + static_cast<std::ptrdiff_t>(page.view.header->first_vertex));
    for (hypermesh::Tet tet : page.view.tets) {
      for (std::uint32_t& v : tet) v = static_cast<std::uint32_t>(page.view.globalOf(v));
      tets.push_back(tet);
    }
  }
  const auto last = static_cast<float>(file.header().frames - 1);
  for (const auto& [place, times] :
       {std::pair{"at frames", std::vector<float>{0, 1, std::floor(last / 2), last}},
        std::pair{"between frames", std::vector<float>{0.25f, std::floor(last / 3) + 0.5f, last - 0.2f}}}) {
    for (const float t : times) {
      SliceMesh slice;
      sliceTets(tets, positions, {}, t, last, slice);
      const auto measures = measure::measureSlice(slice.positions, slice.triangles);
      EXPECT_TRUE(measures.closed()) << t;
      EXPECT_EQ(measures.euler(), 2) << t;
      double& area = errors[std::string("slice area ") + place];
      double& volume = errors[std::string("slice volume ") + place];
      area = std::max(area, std::abs(measures.area / ball.sliceArea(t) - 1));
      volume = std::max(volume, std::abs(measures.volume / ball.sliceVolume(t) - 1));
    }
  }
}

Outcome outcomeOf(const MovingBall& ball, std::uint64_t size, hypermesh::Split split = hypermesh::Split::kHull) {
  const std::size_t frames = size / 2;
  BallFrames source(ball, size, frames);
  const std::string path = testing::temporaryFile("ball.t4h");
  hypermesh::Options options;
  options.split = split;
  outofcore::ThreadExecutor executor(1);
  outofcore::MemoryBudget memory;
  outofcore::Progress progress;
  auto writer = unwrap(hypermesh::Writer::create(path, hypermesh::meshHeader(source, options), source.times(), {},
                                                 paged::Codec::kRaw, true));
  const auto stats = hypermesh::buildHypermesh(source, writer, options, executor, memory, progress);
  unwrap(writer.close("{}"));

  const auto file = unwrap(hypermesh::File::open(path));
  const auto check = topology::checkHypermesh(file, progress);
  EXPECT_TRUE(check.ok()) << check.faults.front();
  EXPECT_EQ(check.unused_vertices, 0u);
  if (size <= 32) {
    outofcore::MemoryBudget no_limit;
    const auto links = topology::checkLinks(file, no_limit, progress);
    EXPECT_TRUE(links.ok()) << links.faults.front();
  }
  const auto measures = measure::measureHypermesh(file, progress);
  EXPECT_EQ(measures.active_cells, stats.active_cells);
  EXPECT_LT(measures.closure, 1e-12);
  const auto last = static_cast<double>(frames - 1);
  Outcome result;
  result.volume3 = measures.volume3;
  result.tets_per_active_cell = measures.tetsPerActiveCell();
  EXPECT_TRUE(measures.volume4.has_value());
  result.errors["4-volume"] = std::abs(measures.volume4.value_or(0) / ball.volume4(last) - 1);
  result.errors["3-volume"] = std::abs(measures.volume3 / ball.volume3(last) - 1);
  result.errors["swept area"] = std::abs(measures.swept_area / ball.sweptArea(last) - 1);
  measureSlices(file, ball, result.errors);
  std::filesystem::remove(path);
  return result;
}

constexpr std::array<double, 3> kMoving{0.40, 0.23, -0.17}, kStill{0, 0, 0};

TEST(Convergence, AMovingBallIsWithinOnePerCentAndSecondOrder) {
  std::vector<Outcome> runs;
  for (const std::uint64_t size : {16u, 32u, 64u})
    runs.push_back(outcomeOf(ballOf(static_cast<double>(size), kMoving, 0), size));
  for (const auto& [what, error] : runs[2].errors) {
    EXPECT_LT(error, 0.01) << what;
    // Two halvings of the grid step: second order makes them a sixteenth, first order a quarter.
    const double order = std::log2(runs[0].errors.at(what) / error) / 2;
    EXPECT_GT(order, 1.7) << what;
    EXPECT_LT(order, 2.4) << what;
    RecordProperty(what, std::to_string(error) + ", order " + std::to_string(order));
  }
  EXPECT_LT(runs[2].tets_per_active_cell, 6.2);
  EXPECT_GT(runs[2].tets_per_active_cell, 5);
}

TEST(Convergence, BallsThatStandOrGrowAreWithinOnePerCent) {
  for (const auto& ball : {ballOf(64, kStill, 0), ballOf(64, kMoving, 0.1), ballOf(64, kStill, -0.3)}) {
    const Outcome result = outcomeOf(ball, 64);
    for (const auto& [what, error] : result.errors) EXPECT_LT(error, 0.01) << what << ", growth " << ball.growth;
    EXPECT_LT(result.tets_per_active_cell, 6.2);
  }
}

TEST(Convergence, TheKuhnSplitHasTheSameVolumes) {
  const MovingBall ball = ballOf(32, kMoving, 0);
  const Outcome hull = outcomeOf(ball, 32), kuhn = outcomeOf(ball, 32, hypermesh::Split::kKuhn);
  EXPECT_NEAR(kuhn.volume3 / hull.volume3, 1, 0.01);
  for (const auto& [what, error] : kuhn.errors) EXPECT_LT(error, 0.01) << what;
  EXPECT_GT(kuhn.tets_per_active_cell, 4 * hull.tets_per_active_cell);
}

}  // namespace
}  // namespace tet4d
