// Files of several parts and with columns: read, simplified and written.
#include "libpreprocess/qslim4d/mesh_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libpreprocess/measure/column_distance.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/qslim4d/closed_slices.h"

namespace tet4d::qslim4d {
namespace {

namespace marching = hypermesh::testing;

TEST(MeshFile, PartsComeBackAsTheyWere) {
  marching::MemoryFrames<float> frames({15, 15, 15}, 7, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    return static_cast<float>(-std::hypot(f(x) - 6.5 - 0.2 * f(k), f(y) - 7, f(z) - 7));
  });
  hypermesh::Options extraction;
  extraction.iso = -5.3;
  extraction.more_isos = {-3.2, -1.7};
  const std::string path = marching::temporaryPath("parts_in.t4h"), out = marching::temporaryPath("parts_out.t4h");
  const marching::ExtractedMesh mesh = marching::extractTo(path, frames, extraction);
  const hypermesh::File file = std::move(hypermesh::File::open(path)).value();
  const std::vector<std::uint64_t> counts = tetsByPart(file);
  ASSERT_EQ(counts.size(), 3u);
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  std::vector<PackedMesh> parts;
  for (std::size_t part = 0; part < 3; ++part) {
    ReadOptions options;
    options.part = part;
    SlimMesh slim = readMesh(file, options, progress);
    EXPECT_EQ(slim.live_tets, counts[part]);
    Options to_a_third;
    to_a_third.target_tets = counts[part] / 3;
    simplify(slim, to_a_third, executor, progress);
    parts.push_back(pack(slim));
  }
  const std::vector<double> isovalues{-5.3, -3.2, -1.7};
  auto writer = hypermesh::Writer::create(out, mesh.header, mesh.times, {}, paged::Codec::kRaw, true, isovalues);
  ASSERT_TRUE(writer.ok());
  writeMeshes(parts, writer.value(), progress);
  ASSERT_TRUE(writer.value().close("{}").ok());
  const hypermesh::File result = std::move(hypermesh::File::open(out)).value();
  EXPECT_TRUE(result.verify().ok()) << result.verify().fault().what;
  ASSERT_EQ(result.parts().size(), 3u);
  EXPECT_EQ(result.parts()[1].isovalue, -3.2);
  for (std::size_t part = 0; part < 3; ++part) {
    EXPECT_EQ(tetsByPart(result)[part], parts[part].tets.size());
    ReadOptions options;
    options.part = part;
    const SlimMesh again = readMesh(result, options, progress);
    EXPECT_EQ(again.positions, parts[part].vertices) << part;
    EXPECT_EQ(testing::liveTets(again), parts[part].tets);
    EXPECT_TRUE(topology::checkLinks(again.tets, again.positions.size(), true).ok());
  }
}

// A ball with columns whose values are known, `shift` added to one of them.
void writeBall(const std::string& path, float shift) {
  marching::MemoryFrames<float> frames({13, 13, 13}, 4, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    return static_cast<float>(4.1 + 0.2 * f(k) - std::hypot(f(x) - 6, f(y) - 6.2, f(z) - 6));
  });
  hypermesh::Options extraction;
  extraction.iso = 0;
  const marching::ExtractedMesh mesh = marching::extract(frames, extraction);
  SlimMesh slim = makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, {}, Metric::kSlice);
  std::vector<SlimColumn> columns(4);
  columns[0].name = "height", columns[1].name = "zone", columns[2].name = "normal", columns[2].components = 3;
  columns[3].name = "constant";
  for (const Vec4f& v : slim.positions) {
    columns[0].values.push_back(v.z + v.t + shift);
    columns[1].values.push_back(v.x < 6 ? 1.0F : 4.0F);
    columns[2].values.insert(columns[2].values.end(), {0, 0.6F, 0.8F});
    columns[3].values.push_back(0.5F);
  }
  slim.columns.list = columns;
  const std::vector<Column> declared{{"height", 1}, {"zone", 1}, {"normal", 3}, {"constant", 1}};
  auto writer = hypermesh::Writer::create(path, mesh.header, mesh.times, declared, paged::Codec::kRaw, true);
  ASSERT_TRUE(writer.ok());
  outofcore::Progress progress;
  writeMesh(slim, 0, writer.value(), progress);
  ASSERT_TRUE(writer.value().close("{}").ok());
}

TEST(MeshFile, ColumnsAreFoundForWhatTheyAreAndComeBack) {
  const std::string path = marching::temporaryPath("columns_in.t4h");
  writeBall(path, 0);
  const hypermesh::File file = std::move(hypermesh::File::open(path)).value();
  ASSERT_TRUE(file.verify().ok());
  outofcore::Progress progress;
  const std::vector<ColumnWish> wishes{{0, true, {}}, {1, false, {}}, {2, false, {}}, {3, true, 2.0}};
  ReadOptions options;
  options.columns = planColumns(file, wishes, progress);
  const SlimMesh slim = readMesh(file, options, progress);
  const auto& list = slim.columns.list;
  ASSERT_EQ(list.size(), 4u);
  EXPECT_EQ(list[0].kind, ColumnKind::kValue);
  EXPECT_EQ(list[1].kind, ColumnKind::kLabel) << "whole numbers only";
  EXPECT_EQ(list[2].kind, ColumnKind::kNormal);
  EXPECT_NEAR(list[0].weight * (double{list[0].high[0]} - list[0].low[0]), 10, 1e-6) << "its range is ten cells";
  EXPECT_EQ(list[3].weight, 0) << "a constant says nothing, whatever its weight";
  EXPECT_EQ(slim.columns.terms, 1u);
  for (std::size_t v = 0; v < slim.positions.size(); ++v) {
    EXPECT_EQ(list[0].values[v], slim.positions[v].z + slim.positions[v].t);
    EXPECT_EQ(list[1].values[v], slim.positions[v].x < 6 ? 1 : 4);
    EXPECT_EQ(list[2].values[3 * v + 2], 0.8F);
  }
}

TEST(ColumnDistance, OfAShiftedColumnIsTheShift) {
  const std::string path = marching::temporaryPath("columns_a.t4h"), other = marching::temporaryPath("columns_b.t4h");
  writeBall(path, 0), writeBall(other, 0.25F);
  const hypermesh::File a = std::move(hypermesh::File::open(path)).value();
  const hypermesh::File b = std::move(hypermesh::File::open(other)).value();
  outofcore::Progress progress;
  const auto shifted = measure::compareColumns(a, b, {0, 1.37, 3}, progress);
  ASSERT_EQ(shifted.size(), 4u);
  EXPECT_EQ(shifted[0].name, "height");
  EXPECT_NEAR(shifted[0].rms, 0.25, 1e-4);
  EXPECT_NEAR(shifted[0].max, 0.25, 1e-4);
  EXPECT_GT(shifted[0].samples, 1000u);
  for (std::size_t c = 1; c < 4; ++c) EXPECT_LT(shifted[c].max, 1e-5) << shifted[c].name;
}

}  // namespace
}  // namespace tet4d::qslim4d
