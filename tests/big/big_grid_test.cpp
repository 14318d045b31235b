// A grid of more than 2^31 samples a frame: no index or count may be of 32 bits. Needs about 9 GB of memory.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "libpreprocess/hypermesh/marching_hypercubes.h"

namespace tet4d::hypermesh {
namespace {

// Outside everywhere but in a ball that touches the last samples of the grid.
class FarBall final : public exchange::FrameSource {
 public:
  FarBall() {
    grid_.dims = {2048, 1024, 1050};
    grid_.type = SampleType::kU8;
  }
  const exchange::GridInfo& grid() const override { return grid_; }
  const std::vector<double>& times() const override { return times_; }
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    std::memset(samples.data(), 0, samples.size());
    for (std::uint64_t z = std::max<std::uint64_t>(z_begin, grid_.dims[2] - 32); z < z_end; ++z)
      for (std::uint64_t y = grid_.dims[1] - 32; y < grid_.dims[1]; ++y)
        for (std::uint64_t x = grid_.dims[0] - 32; x < grid_.dims[0]; ++x)
          samples[((z - z_begin) * grid_.dims[1] + y) * grid_.dims[0] + x] = std::byte(value(x, y, z, k));
  }
  std::string frameName(std::size_t k) const override { return "frame " + std::to_string(k); }

  static constexpr double kRadius = 10.4;
  std::array<double, 3> centre() const {
    return {static_cast<double>(grid_.dims[0]) - 16.2, static_cast<double>(grid_.dims[1]) - 15.7,
            static_cast<double>(grid_.dims[2]) - 15.9};
  }

 private:
  unsigned value(std::uint64_t x, std::uint64_t y, std::uint64_t z, std::size_t) const {
    const auto c = centre();
    const double r =
        std::hypot(static_cast<double>(x) - c[0], static_cast<double>(y) - c[1], static_cast<double>(z) - c[2]);
    return static_cast<unsigned>(std::clamp(100 + 10 * (kRadius - r), 0.0, 255.0));
  }
  exchange::GridInfo grid_;
  std::vector<double> times_{0, 1};
};

// Keeps what matters of the pages.
class Kept final : public PageSink {
 public:
  void add(const Page& page) override {
    vertices.insert(vertices.end(), page.vertices.begin(), page.vertices.end());
    tets.insert(tets.end(), page.tets.begin(), page.tets.end());
  }
  void addFlags(std::uint32_t) override {}
  void setTimes(std::span<const double>, float) override {}
  std::vector<Vec4f> vertices;
  std::vector<Tet> tets;
};

TEST(BigGrid, MoreThanTwoToThe31Samples) {
  FarBall source;
  ASSERT_GT(source.grid().voxels(), std::uint64_t{1} << 31);
  Kept kept;
  outofcore::ThreadExecutor executor(2);
  outofcore::MemoryBudget memory;
  outofcore::Progress progress;
  const Stats stats = buildHypermesh(source, kept, {.iso = 99.5}, executor, memory, progress);
  EXPECT_EQ(stats.voxels, 2 * source.grid().voxels());
  ASSERT_GT(kept.tets.size(), 1000U);
  const auto c = source.centre();
  for (const Vec4f& v : kept.vertices) {
    const double r = std::hypot(double{v.x} - c[0], double{v.y} - c[1], double{v.z} - c[2]);
    EXPECT_NEAR(r, FarBall::kRadius, 0.2);
  }
}

}  // namespace
}  // namespace tet4d::hypermesh
