// The extractor against brute force, itself on other threads, and geometry.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/crossing.h"
#include "libpreprocess/hypermesh/split_tables.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::hypermesh {
namespace {

using testing::extract;
using testing::ExtractedMesh;
using testing::manifoldFaults;
using testing::MemoryFrames;

// Values in [0, 1), independent of the library's distributions.
MemoryFrames<float> noise(std::array<std::uint64_t, 3> dims, std::size_t frames, std::uint32_t seed) {
  std::mt19937 random(seed);
  return {dims, frames, [&](auto, auto, auto, auto) { return static_cast<float>(random() >> 8) / 16777216.0F; }};
}

MemoryFrames<float> noiseWithNans(std::array<std::uint64_t, 3> dims, std::size_t frames, std::uint32_t seed,
                                  double share) {
  std::mt19937 random(seed);
  return {dims, frames, [&](auto, auto, auto, auto) {
            const bool nan = static_cast<double>(random()) < share * 4294967296.0;
            const float value = static_cast<float>(random() >> 8) / 16777216.0F;
            return nan ? std::numeric_limits<float>::quiet_NaN() : value;
          }};
}

struct MovingSphere {
  double radius, velocity, start;  // centre (start + velocity * frame, middle, middle)
  double middle;
  double value(double x, double y, double z, double t) const {
    return radius -
           std::sqrt(std::pow(x - start - velocity * t, 2) + std::pow(y - middle, 2) + std::pow(z - middle, 2));
  }
};

MemoryFrames<float> frames(const MovingSphere& s, std::uint64_t n, std::size_t count) {
  return {{n, n, n}, count, [&](auto x, auto y, auto z, auto t) {
            return static_cast<float>(s.value(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z),
                                              static_cast<double>(t)));
          }};
}

// What the header promises, with a map from edges to numbers and no bit tricks.
struct BruteForce {
  std::vector<Vec4f> vertices;
  std::vector<Tet> tets;
  std::uint64_t active_cells = 0, masked_cells = 0;
};

BruteForce bruteForce(const MemoryFrames<float>& source, const Options& options) {
  const CellTable& table = tableOf(options.split);
  const auto& dims = source.grid().dims;
  const std::uint64_t frames = source.times().size();
  using Key = std::array<std::uint64_t, 5>;  // axes, x, y, z, frame
  const auto inside = [&](std::uint64_t x, std::uint64_t y, std::uint64_t z, std::uint64_t k) {
    return double{source.at(x, y, z, k)} >= options.iso;
  };
  BruteForce out;
  std::vector<std::array<Key, 4>> tets;
  std::map<Key, std::uint32_t> number;
  for (std::uint64_t k = 0; k + 1 < frames; ++k)
    for (std::uint64_t z = 0; z + 1 < dims[2]; ++z)
      for (std::uint64_t y = 0; y + 1 < dims[1]; ++y)
        for (std::uint64_t x = 0; x + 1 < dims[0]; ++x) {
          unsigned configuration = 0;
          bool nan = false;
          for (unsigned c = 0; c < 16; ++c) {
            const std::array<std::uint64_t, 4> p{x + (c & 1), y + (c >> 1 & 1), z + (c >> 2 & 1), k + (c >> 3 & 1)};
            configuration |= static_cast<unsigned>(inside(p[0], p[1], p[2], p[3])) << c;
            nan |= std::isnan(source.at(p[0], p[1], p[2], p[3]));
          }
          if (nan && options.nan == NanRule::kMask) {
            ++out.masked_cells;
            continue;
          }
          out.active_cells += configuration != 0 && configuration != 65535;
          for (const CellTet& tet : table.of(configuration)) {
            std::array<Key, 4> keys{};
            for (std::size_t i = 0; i < 4; ++i) {
              const CellEdge e = table.edges[tet[i]];
              keys[i] = {e.direction, x + (e.base & 1U), y + (e.base >> 1 & 1U), z + (e.base >> 2 & 1U),
                         k + (e.base >> 3 & 1U)};
              number[keys[i]] = 0;
            }
            tets.push_back(keys);
          }
        }
  // Global order: frame; inside the frame before through time; direction; z, y, x.
  std::map<std::array<std::uint64_t, 6>, Key> ordered;
  for (const auto& [key, unused] : number) ordered[{key[4], key[0] >> 3 & 1, key[0], key[3], key[2], key[1]}] = key;
  for (const auto& [order, key] : ordered) {
    number[key] = static_cast<std::uint32_t>(out.vertices.size());
    const auto [axes, x, y, z, k] = key;
    const std::array<std::uint64_t, 4> base{x, y, z, k};
    const double f = crossingFraction(
        source.at(x, y, z, k), source.at(x + (axes & 1), y + (axes >> 1 & 1), z + (axes >> 2 & 1), k + (axes >> 3)),
        options.iso);
    std::array<float, 4> p{};
    for (std::size_t axis = 0; axis < 4; ++axis)
      p[axis] = static_cast<float>(static_cast<double>(base[axis]) + (axes >> axis & 1 ? f : 0.0));
    out.vertices.push_back({p[0], p[1], p[2], p[3]});
  }
  for (const auto& keys : tets)
    out.tets.push_back({number[keys[0]], number[keys[1]], number[keys[2]], number[keys[3]]});
  return out;
}

struct Case {
  std::array<std::uint64_t, 3> dims;
  std::size_t frames;
  double iso;
};

class EverySplit : public ::testing::TestWithParam<Split> {};
INSTANTIATE_TEST_SUITE_P(Marching, EverySplit, ::testing::Values(Split::kHull, Split::kKuhn),
                         [](const auto& split) { return split.param == Split::kHull ? "Hull" : "Kuhn"; });

TEST_P(EverySplit, EqualsBruteForce) {
  // Rows of one word, exactly one, one and a bit, two and a bit; the smallest grid; sparse and dense surfaces.
  const Case cases[] = {{{2, 2, 2}, 2, 0.5},  {{5, 4, 3}, 4, 0.5},    {{64, 3, 2}, 2, 0.1}, {{65, 2, 3}, 3, 0.9},
                        {{66, 3, 2}, 2, 0.5}, {{130, 2, 2}, 3, 0.02}, {{3, 5, 6}, 5, 0.97}};
  std::uint32_t seed = 1;
  for (const Case& c : cases) {
    MemoryFrames<float> source = noise(c.dims, c.frames, seed++);
    const Options options{.iso = c.iso, .split = GetParam()};
    const ExtractedMesh mesh = extract(source, options);
    const BruteForce expected = bruteForce(source, options);
    ASSERT_EQ(mesh.vertices, expected.vertices);
    ASSERT_EQ(mesh.tets, expected.tets);
    EXPECT_EQ(mesh.stats.active_cells, expected.active_cells);
    EXPECT_EQ(mesh.stats.vertices, mesh.vertices.size());
    EXPECT_EQ(mesh.stats.tets, mesh.tets.size());
    EXPECT_EQ(mesh.stats.frames, c.frames);
    EXPECT_EQ(mesh.stats.voxels, c.frames * source.grid().voxels());
  }
}

TEST_P(EverySplit, EqualsBruteForceWithMaskedCells) {
  const Case cases[] = {{{5, 4, 6}, 5, 0.5}, {{70, 4, 4}, 4, 0.3}, {{2, 2, 2}, 6, 0.5}, {{4, 70, 3}, 3, 0.5}};
  std::uint32_t seed = 20;
  for (const Case& c : cases) {
    for (const double share : {0.003, 0.03, 0.3}) {
      MemoryFrames<float> source = noiseWithNans(c.dims, c.frames, seed++, share);
      const Options options{.iso = c.iso, .split = GetParam(), .nan = NanRule::kMask};
      const ExtractedMesh mesh = extract(source, options);
      const BruteForce expected = bruteForce(source, options);
      ASSERT_EQ(mesh.vertices, expected.vertices);
      ASSERT_EQ(mesh.tets, expected.tets);
      EXPECT_EQ(mesh.stats.masked_cells, expected.masked_cells);
      EXPECT_EQ((mesh.header.flags & kInnerBoundary) != 0, expected.masked_cells > 0);
    }
  }
}

TEST_P(EverySplit, RandomSignsGiveAManifold) {
  std::uint32_t seed = 100;
  for (const double iso : {0.03, 0.2, 0.5, 0.8, 0.97}) {
    MemoryFrames<float> source = noise({6, 6, 6}, 6, seed++);
    EXPECT_EQ(manifoldFaults(source, {.iso = iso, .split = GetParam()}), "") << "isovalue " << iso;
  }
}

TEST_P(EverySplit, MaskedCellsLeaveNoLooseEnds) {
  MemoryFrames<float> source = noiseWithNans({6, 6, 6}, 6, 7, 0.002);
  const ExtractedMesh mesh = extract(source, {.iso = 0.5, .split = GetParam(), .nan = NanRule::kMask});
  ASSERT_GT(mesh.stats.masked_cells, 0U);
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Tet& tet : mesh.tets)
    for (const std::uint32_t v : tet) used[v] = true;
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST_P(EverySplit, MovingSphereHasItsVolumes) {
  const MovingSphere sphere{8.3, 0.31, 10.2, 12.1};
  MemoryFrames<float> source = frames(sphere, 25, 10);
  const ExtractedMesh mesh = extract(source, {.iso = 0, .split = GetParam()});
  const double duration = 9, r = sphere.radius, v = sphere.velocity;
  EXPECT_NEAR(enclosedFourVolume(mesh) / (4.0 / 3.0 * std::numbers::pi * r * r * r * duration), 1, 0.01);
  // Area element of the moving surface: sqrt(1 + (v cos)^2) dA dt, integrated over the cosine.
  const double integral = std::sqrt(1 + v * v) + std::asinh(v) / v;
  EXPECT_NEAR(threeVolume(mesh) / (2 * std::numbers::pi * r * r * duration * integral), 1, 0.01);
}

// The error against the exact volume falls with the square of the step: halve it, and a quarter is left.
TEST(Marching, VolumeIsSecondOrder) {
  std::array<double, 2> errors{};
  for (const std::uint64_t scale : {1U, 2U}) {
    const double s = static_cast<double>(scale);
    const MovingSphere sphere{5.2 * s, 0.41, 7.3 * s, 8.1 * s};
    MemoryFrames<float> source = frames(sphere, 16 * scale + 1, 5 * scale + 1);
    const double exact = 4.0 / 3.0 * std::numbers::pi * std::pow(sphere.radius, 3) * 5 * s;
    errors[scale - 1] = std::abs(enclosedFourVolume(extract(source, {.iso = 0})) / exact - 1);
  }
  EXPECT_LT(errors[1], errors[0] / 3);
}

TEST(Marching, HypersphereEnclosesItsVolumeWithoutWalls) {
  const double r = 12.3;
  MemoryFrames<double> source({28, 28, 28}, 28, [&](auto x, auto y, auto z, auto t) {
    const auto d = [](auto i) { return std::pow(static_cast<double>(i) - 13.4, 2); };
    return r - std::sqrt(d(x) + d(y) + d(z) + d(t));
  });
  const ExtractedMesh mesh = extract(source, {.iso = 0});
  const double pi2 = std::numbers::pi * std::numbers::pi;
  EXPECT_NEAR(enclosedFourVolume(mesh) / (pi2 / 2 * std::pow(r, 4)), 1, 0.01);
  EXPECT_NEAR(threeVolume(mesh) / (2 * pi2 * std::pow(r, 3)), 1, 0.01);
}

TEST(Marching, SmoothDataStaysBelowTheTetrahedraOfAHyperplane) {
  MemoryFrames<float> source = frames({8.3, 0.31, 10.2, 12.1}, 25, 10);
  const ExtractedMesh hull = extract(source, {.iso = 0}), kuhn = extract(source, {.iso = 0, .split = Split::kKuhn});
  EXPECT_EQ(hull.stats.active_cells, kuhn.stats.active_cells);
  EXPECT_LE(static_cast<double>(hull.stats.tets), 6.2 * static_cast<double>(hull.stats.active_cells));
  EXPECT_GT(static_cast<double>(kuhn.stats.tets), 5 * static_cast<double>(hull.stats.tets));
  EXPECT_NEAR(threeVolume(hull) / threeVolume(kuhn), 1, 0.01);
}

TEST_P(EverySplit, PositiveNormalsPointOutOfTheSphere) {
  const MovingSphere s{8.3, 0.31, 10.2, 12.1};
  MemoryFrames<float> source = frames(s, 25, 10);
  const ExtractedMesh mesh = extract(source, {.iso = 0, .split = GetParam()});
  std::size_t outward = 0;
  for (const Tet& tet : mesh.tets) {
    std::array<double, 4> p{};
    for (const std::uint32_t v : tet) {
      const Vec4f& q = mesh.vertices[v];
      p[0] += q.x / 4.0, p[1] += q.y / 4.0, p[2] += q.z / 4.0, p[3] += q.t / 4.0;
    }
    const double dx = p[0] - s.start - s.velocity * p[3], dy = p[1] - s.middle, dz = p[2] - s.middle;
    const auto n = normalOf(mesh, tet);
    outward += n[0] * dx + n[1] * dy + n[2] * dz - n[3] * s.velocity * dx > 0;
  }
  EXPECT_GT(static_cast<double>(outward), 0.998 * static_cast<double>(mesh.tets.size()));
}

TEST_P(EverySplit, BytesDoNotDependOnThreads) {
  for (const NanRule nan : {NanRule::kOutside, NanRule::kMask}) {
    MemoryFrames<float> source = noiseWithNans({67, 5, 9}, 4, 5, 0.01);
    const Options options{.iso = 0.5, .split = GetParam(), .nan = nan};
    const ExtractedMesh one = extract(source, options, 1), three = extract(source, options, 3);
    ASSERT_FALSE(one.tets.empty());
    EXPECT_EQ(one.bytes, three.bytes);
    EXPECT_EQ(one.stats.samples_xxh3, three.stats.samples_xxh3);
  }
}

TEST(Marching, ReadsEveryFrameOnceInOrder) {
  MemoryFrames<float> source = noise({4, 4, 4}, 6, 3);
  extract(source, {.iso = 0.5});
  EXPECT_EQ(source.reads, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

TEST(Marching, DigestIsOfTheDecodedSamples) {
  MemoryFrames<float> source = noise({4, 5, 6}, 3, 3);
  std::vector<std::uint64_t> frames;
  for (std::size_t k = 0; k < 3; ++k)
    frames.push_back(container::xxh3(std::as_bytes(source.samples().subspan(k * 120, 120))));
  EXPECT_EQ(extract(source, {.iso = 0.5}).stats.samples_xxh3, container::xxh3(std::as_bytes(std::span(frames))));
}

TEST(Marching, PagesOwnTheirFrameAndTheLastOneTwo) {
  MemoryFrames<float> source = noise({5, 5, 5}, 4, 3);
  const ExtractedMesh mesh = extract(source, {.iso = 0.5});
  ASSERT_EQ(mesh.pages.size(), 3U);
  std::size_t first = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t v = first; v < first + mesh.pages[k][0]; ++v) {
      const float t = mesh.vertices[v].t;
      EXPECT_TRUE(t >= static_cast<float>(k) && (t < static_cast<float>(k + 1) || (k == 2 && t == 3)));
    }
    first += mesh.pages[k][0];
  }
}

TEST(Marching, CompressedPagesHoldTheSameMesh) {
  if (!paged::hasCodec(paged::Codec::kZstd)) GTEST_SKIP() << "this build has no zstd";
  MemoryFrames<float> source = noise({9, 9, 9}, 4, 3);
  const ExtractedMesh raw = extract(source, {.iso = 0.5});
  const ExtractedMesh packed = extract(source, {.iso = 0.5, .page_codec = paged::Codec::kZstd});
  EXPECT_EQ(packed.vertices, raw.vertices);
  EXPECT_EQ(packed.tets, raw.tets);
  EXPECT_LT(packed.bytes.size(), raw.bytes.size());
}

// The same numbers give the same mesh in every sample type that holds them.
template <class T>
ExtractedMesh ofBytes() {
  std::mt19937 random(11);
  MemoryFrames<T> source({6, 5, 4}, 4, [&](auto, auto, auto, auto) { return static_cast<T>(random() % 100); });
  return extract(source, {.iso = 50.5});
}

TEST(Marching, SampleTypesAgree) {
  const ExtractedMesh bytes = ofBytes<std::uint8_t>();
  ASSERT_FALSE(bytes.tets.empty());
  for (const ExtractedMesh& other : {ofBytes<std::int16_t>(), ofBytes<std::int32_t>(), ofBytes<std::int64_t>(),
                                     ofBytes<float>(), ofBytes<double>()}) {
    EXPECT_EQ(other.vertices, bytes.vertices);
    EXPECT_EQ(other.tets, bytes.tets);
  }
}

TEST(Marching, PlanBoundsTheRun) {
  MemoryFrames<float> source = noise({12, 11, 10}, 5, 9);
  for (const NanRule nan : {NanRule::kOutside, NanRule::kMask}) {
    const Options options{.iso = 0.5, .nan = nan};
    const Plan bound = plan(source, options);
    const ExtractedMesh mesh = extract(source, options);
    EXPECT_LE(mesh.bytes.size(), bound.most_output_bytes);
    EXPECT_GE(mesh.bytes.size(), bound.least_output_bytes);
    const ExtractedMesh empty = extract(source, {.iso = 7, .nan = nan});
    ASSERT_TRUE(empty.tets.empty());
    EXPECT_GE(empty.bytes.size(), bound.least_output_bytes);
    EXPECT_LT(empty.bytes.size(), bound.least_output_bytes + 4096);
    outofcore::MemoryBudget tight(bound.fixed_bytes - 1), roomy(bound.fixed_bytes + bound.most_page_bytes);
    outofcore::ThreadExecutor executor(1);
    outofcore::Progress progress;
    const auto build = [&](outofcore::MemoryBudget& memory) {
      Writer writer = unwrap(Writer::create(testing::temporaryPath("plan.t4h"), meshHeader(source, options),
                                            source.times(), {}, options.page_codec, true));
      return buildHypermesh(source, writer, options, executor, memory, progress).tets;
    };
    EXPECT_EQ(build(roomy), mesh.tets.size());
    try {
      build(tight);
      FAIL() << "a budget below the plan was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.fault().code, FaultCode::kOutOfMemory);
    }
  }
}

}  // namespace
}  // namespace tet4d::hypermesh
