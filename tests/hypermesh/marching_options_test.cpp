// Parts, padding, streams, both sets of instructions: what the options change and what they must not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/crossing.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::hypermesh {
namespace {

using testing::extract;
using testing::ExtractedMesh;
using testing::extractTo;
using testing::manifoldFaults;
using testing::MemoryFrames;

template <class T>
MemoryFrames<T> noise(std::array<std::uint64_t, 3> dims, std::size_t frames, std::uint32_t seed) {
  std::mt19937 random(seed);
  return {dims, frames, [&](auto, auto, auto, auto) { return static_cast<T>(random() >> 8 & 0x7f); }};
}

// Blobs that fill part of the rows, so that whole rows are alike.
MemoryFrames<float> blobs(std::array<std::uint64_t, 3> dims, std::size_t frames) {
  return {dims, frames, [=](auto x, auto y, auto z, auto t) {
            const double u = static_cast<double>(x) - 0.3 * static_cast<double>(dims[0]) - 0.8 * static_cast<double>(t);
            const double v = static_cast<double>(y) - 0.5 * static_cast<double>(dims[1]);
            const double w = static_cast<double>(z) - 0.4 * static_cast<double>(dims[2]);
            return static_cast<float>(4.3 - std::sqrt(u * u + v * v + w * w));
          }};
}

TEST(MarchingOptions, BothInstructionSetsGiveTheSameBytes) {
  if (bestSimd() != Simd::kWide) GTEST_SKIP() << "this machine has the portable loops only";
  const auto same = [](exchange::FrameSource& source, Options options) {
    options.simd = Simd::kPortable;
    const auto portable = extract(source, options).bytes;
    options.simd = Simd::kWide;
    EXPECT_EQ(extract(source, options).bytes, portable);
  };
  MemoryFrames<std::uint8_t> bytes = noise<std::uint8_t>({67, 9, 8}, 4, 1);
  same(bytes, {.iso = 63.5});
  MemoryFrames<double> doubles = noise<double>({130, 5, 4}, 3, 2);
  same(doubles, {.iso = 20, .more_isos = {90.5}, .pad = 2, .normals = Normals::kTets, .velocity = true});
  MemoryFrames<float> sparse = blobs({70, 20, 20}, 5);
  same(sparse, {.iso = 0, .split = Split::kKuhn, .normals = Normals::kGradient});
}

TEST(MarchingOptions, RowsThatAreAlikeChangeNothing) {
  // Adding a corner of noise makes no row but its own mixed; the rest of the surface must stay.
  MemoryFrames<float> source = blobs({70, 20, 20}, 5);
  EXPECT_EQ(manifoldFaults(source, {.iso = 0}), "");
  MemoryFrames<float> reversed({70, 20, 20}, 5, [&](auto x, auto y, auto z, auto t) { return -source.at(x, y, z, t); });
  EXPECT_EQ(manifoldFaults(reversed, {.iso = 0}), "");
  const ExtractedMesh outside = extract(source, {.iso = 0}), inside = extract(reversed, {.iso = 0});
  EXPECT_EQ(outside.vertices.size(), inside.vertices.size());
  EXPECT_NEAR(testing::threeVolume(outside), testing::threeVolume(inside), 0.02 * testing::threeVolume(outside));
}

TEST(MarchingOptions, AStreamGivesTheSameBytes) {
  for (const std::size_t frames : {2U, 3U, 6U}) {
    MemoryFrames<std::uint16_t> file = noise<std::uint16_t>({9, 8, 7}, frames, 3), stream = file;
    stream.asStream();
    for (const Options& options : {Options{.iso = 63.5}, Options{.iso = 40, .more_isos = {63, 90}, .pad = 1},
                                   Options{.iso = 63.5, .normals = Normals::kGradient, .velocity = true}}) {
      MemoryFrames<std::uint16_t> fresh = stream;
      const ExtractedMesh from_stream = extract(fresh, options);
      EXPECT_EQ(from_stream.bytes, extract(file, options).bytes);
      EXPECT_EQ(from_stream.header.frames, frames);
      std::vector<std::size_t> in_order(frames);
      std::iota(in_order.begin(), in_order.end(), 0U);
      EXPECT_EQ(fresh.reads, in_order);
    }
  }
}

TEST(MarchingOptions, AStreamOfOneFrameIsRefused) {
  MemoryFrames<float> stream = noise<float>({3, 3, 3}, 1, 4);
  stream.asStream();
  EXPECT_THROW(extract(stream, {.iso = 1}), Error);
}

TEST(MarchingOptions, ThreadsChangeNoBytesOfPartsAndColumns) {
  MemoryFrames<float> source = noise<float>({19, 14, 13}, 5, 5);
  const Options options{.iso = 40, .more_isos = {63.5, 64}, .pad = 1, .normals = Normals::kTets, .velocity = true};
  EXPECT_EQ(extract(source, options, 1).bytes, extract(source, options, 3).bytes);
}

// ---------------------------------------------------------------- padding

TEST(MarchingOptions, PaddingClosesTheSurfaceAtTheWalls) {
  // All inside: the box itself, a little larger than its samples.
  MemoryFrames<std::uint8_t> full({5, 4, 6}, 4, [](auto, auto, auto, auto) { return std::uint8_t{9}; });
  const ExtractedMesh box = extract(full, {.iso = 5, .pad = 1});
  const double e = 2 * kCrossingMargin;
  EXPECT_NEAR(testing::enclosedFourVolume(box), (4 + e) * (3 + e) * (5 + e) * 3, 1e-2);
  for (const Vec4f& v : box.vertices) {
    EXPECT_GE(v.x, -e);
    EXPECT_LE(v.x, 4 + e);
  }
  EXPECT_EQ(box.header.domain.min, (Vec4f{-1, -1, -1, 0}));
  EXPECT_EQ(box.header.domain.max, (Vec4f{5, 4, 6, 3}));
  for (const std::uint64_t pad : {1U, 2U, 64U}) {
    MemoryFrames<std::uint8_t> random = noise<std::uint8_t>({7, 6, 5}, 4, 6);
    EXPECT_EQ(manifoldFaults(random, {.iso = 63.5, .pad = pad}), "") << pad << " layers";
    const std::string path = testing::temporaryPath("padded.t4h");
    const ExtractedMesh mesh = extractTo(path, random, {.iso = 63.5, .pad = pad});
    outofcore::Progress progress;
    const topology::HypermeshCheck check = topology::checkHypermesh(unwrap(File::open(path)), progress);
    EXPECT_EQ(check.inner_boundary_faces, 0U);
    for (const Tet& tet : mesh.tets)  // what bounds the mesh lies at its first and last time only
      for (const std::uint32_t v : tet) EXPECT_GT(std::abs(mesh.vertices[v].x - mesh.header.domain.min.x), 1e-6F);
  }
}

// Padding by NaN samples that count as outside is the same surface by another way.
TEST(MarchingOptions, PaddingEqualsSamplesThatAreOutside) {
  MemoryFrames<float> source = noise<float>({63, 4, 5}, 3, 8);
  for (const std::uint64_t pad : {1U, 3U, 70U}) {
    const auto wide = [&](std::uint64_t n) { return n + 2 * pad; };
    const std::array<std::uint64_t, 3> dims = source.grid().dims;
    MemoryFrames<float> padded({wide(dims[0]), wide(dims[1]), wide(dims[2])}, 3, [&](auto x, auto y, auto z, auto t) {
      const bool is_sample =
          x >= pad && x < dims[0] + pad && y >= pad && y < dims[1] + pad && z >= pad && z < dims[2] + pad;
      return is_sample ? source.at(x - pad, y - pad, z - pad, t) : std::numeric_limits<float>::quiet_NaN();
    });
    for (const Split split : {Split::kHull, Split::kKuhn}) {
      const ExtractedMesh ours = extract(source, {.iso = 63.5, .split = split, .pad = pad});
      const ExtractedMesh theirs = extract(padded, {.iso = 63.5, .split = split});
      ASSERT_EQ(ours.tets, theirs.tets);
      ASSERT_EQ(ours.vertices.size(), theirs.vertices.size());
      for (std::size_t i = 0; i < ours.vertices.size(); ++i) {
        EXPECT_NEAR(ours.vertices[i].x + static_cast<float>(pad), theirs.vertices[i].x, 3e-5);
        EXPECT_NEAR(ours.vertices[i].z + static_cast<float>(pad), theirs.vertices[i].z, 3e-5);
        EXPECT_EQ(ours.vertices[i].t, theirs.vertices[i].t);
      }
    }
  }
}

TEST(MarchingOptions, PaddingAndMaskedCells) {
  MemoryFrames<float> source({6, 6, 6}, 4, [](auto x, auto y, auto z, auto t) {
    return x == 3 && y == 2 && z == 2 && t == 1 ? std::numeric_limits<float>::quiet_NaN() : 1.0F;
  });
  const ExtractedMesh mesh = extract(source, {.iso = 0.5, .nan = NanRule::kMask, .pad = 2});
  EXPECT_EQ(mesh.stats.masked_cells, 16U);
  EXPECT_EQ(mesh.stats.nan_samples, 1U);
  try {
    extract(source, {.iso = 0.5, .nan = NanRule::kError, .pad = 2});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.fault().place.find("sample 3 2 2"), std::string::npos) << error.fault().place;
  }
}

// ---------------------------------------------------------------- parts

// The tetrahedra of one part as positions.
std::vector<std::array<Vec4f, 4>> partTets(const ExtractedMesh& mesh, std::uint64_t part) {
  std::vector<std::array<Vec4f, 4>> result;
  std::size_t tet = 0;
  for (std::size_t k = 0; k < mesh.pages.size(); ++k) {
    for (std::uint64_t i = 0; i < mesh.pages[k][1]; ++i, ++tet) {
      if (mesh.page_parts[k] != part) continue;
      std::array<Vec4f, 4> corners{};
      for (std::size_t c = 0; c < 4; ++c) corners[c] = mesh.vertices[mesh.tets[tet][c]];
      result.push_back(corners);
    }
  }
  return result;
}

TEST(MarchingOptions, PartsAreTheSurfacesOfTheirIsovalues) {
  for (const std::size_t frames : {2U, 3U, 5U}) {
    MemoryFrames<float> source = noise<float>({9, 8, 7}, frames, 11);
    const std::vector<double> isovalues{63.5, 20, 900, 100};  // one has no surface
    const ExtractedMesh mesh =
        extract(source, {.iso = isovalues[0], .more_isos = {isovalues[1], isovalues[2], isovalues[3]}});
    EXPECT_TRUE(std::isnan(mesh.header.isovalue));
    EXPECT_EQ(mesh.header.parts, isovalues.size());
    std::uint64_t tets = 0, vertices = 0;
    for (std::size_t p = 0; p < isovalues.size(); ++p) {
      const ExtractedMesh alone = extract(source, {.iso = isovalues[p]});
      EXPECT_EQ(partTets(mesh, p), partTets(alone, 0)) << "isovalue " << isovalues[p];
      EXPECT_EQ(mesh.stats.parts[p].tets, alone.tets.size());
      EXPECT_EQ(mesh.stats.parts[p].vertices, alone.vertices.size());
      tets += alone.tets.size(), vertices += alone.vertices.size();
    }
    EXPECT_EQ(mesh.tets.size(), tets);
    EXPECT_EQ(mesh.vertices.size(), vertices);
    EXPECT_EQ(manifoldFaults(source, {.iso = isovalues[0], .more_isos = {isovalues[1]}}), "");
  }
}

TEST(MarchingOptions, PartsUnderMasks) {
  MemoryFrames<float> source({7, 6, 6}, 5, [](auto x, auto y, auto z, auto t) {
    const bool nan = x == 2 + t && y == 3 && z == 2;
    return nan ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>((x * 7 + y * 5 + z * 3 + t * 2) % 11);
  });
  const ExtractedMesh mesh = extract(source, {.iso = 4.5, .more_isos = {8.5}, .nan = NanRule::kMask});
  for (const std::uint64_t p : {0U, 1U}) {
    const ExtractedMesh alone = extract(source, {.iso = p == 0 ? 4.5 : 8.5, .nan = NanRule::kMask});
    EXPECT_EQ(partTets(mesh, p), partTets(alone, 0));
  }
}

TEST(MarchingOptions, IsovaluesThatCannotBeAreRefused) {
  MemoryFrames<float> source = noise<float>({3, 3, 3}, 2, 1);
  EXPECT_THROW(extract(source, {.iso = 1, .more_isos = {2, 1}}), Error);
  EXPECT_THROW(extract(source, {.iso = 1, .more_isos = {std::numeric_limits<double>::infinity()}}), Error);
  EXPECT_THROW(extract(source, {.iso = 0, .more_isos = std::vector<double>(64, 1.0)}), Error);
  EXPECT_THROW(extract(source, {.iso = 1, .pad = 4097}), Error);
}

// ---------------------------------------------------------------- memory

TEST(MarchingOptions, FramesStandInTheirOwnType) {
  MemoryFrames<std::uint8_t> bytes = noise<std::uint8_t>({64, 64, 32}, 3, 1);
  MemoryFrames<float> floats = noise<float>({64, 64, 32}, 3, 1);
  const std::uint64_t voxels = bytes.grid().voxels();
  EXPECT_EQ(plan(floats, {.iso = 200}).fixed_bytes - plan(bytes, {.iso = 200}).fixed_bytes, 2 * 3 * voxels);
  EXPECT_EQ(
      plan(bytes, {.iso = 200, .normals = Normals::kGradient}).fixed_bytes - plan(bytes, {.iso = 200}).fixed_bytes,
      2 * voxels);
  // Beside the frames: at most two and a half bytes a sample, on grids whose rows fill their words.
  EXPECT_LE(plan(bytes, {.iso = 200}).fixed_bytes, 2 * voxels + 5 * voxels / 2);
}

}  // namespace
}  // namespace tet4d::hypermesh
