// What cells carry beside the geometry: columns, the metric's among them, parts, places that are no manifold, and a
// promise; the same for any means, and after any interrupt.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <map>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/column_distance.h"
#include "libpreprocess/measure/slice_bound.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/outofcore/work_folder.h"
#include "libpreprocess/qslim4d/cell_files.h"
#include "libpreprocess/qslim4d/cell_tree.h"
#include "libpreprocess/qslim4d/packed_mesh.h"
#include "libpreprocess/qslim4d/scatter.h"
#include "libpreprocess/qslim4d/stream_writer.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"
#include "tests/qslim4d/cell_scenes.h"

namespace tet4d::qslim4d {
namespace {

namespace marching = hypermesh::testing;
using testing::balls;
using testing::bytesOf;
using testing::CellMeans;
using testing::expectSound;
using testing::fields;
using testing::inCells;
using testing::open;
using testing::simplifyTo;
using testing::targetsOf;

const std::vector<std::string> kWave{"wave"};

Options toTets(std::uint64_t target) {
  Options options;
  options.target_tets = target;
  return options;
}

TEST(CellsLoad, TheSameBytesForAnyThreadsAndMemory) {
  const std::string in = marching::temporaryPath("load_in.t4h"), out = marching::temporaryPath("load_out.t4h");
  balls(in, true, fields());
  const hypermesh::File file = open(in);
  CellOptions cells = inCells(file.header().tets / 9);
  cells.targets = targetsOf(file, 8);
  const std::vector<ColumnWish> wishes{{0, true, {}}, {1, false, {}}, {2, false, {}}};
  const std::uint64_t least = boundCellMemory(file, cells.cell_tets, wishes);
  for (const Order order : {Order::kPasses, Order::kMultichoice}) {
    const CellReport first = simplifyTo(out, file, {}, cells, {1, 0, nullptr, order}, kWave);
    EXPECT_GE(first.sweeps[0].cells, 8U);
    const std::string bytes = bytesOf(out);
    for (const CellMeans& means : {CellMeans{3, 0, nullptr, order}, CellMeans{4, least, nullptr, order}}) {
      simplifyTo(out, file, {}, cells, means, kWave);
      EXPECT_TRUE(bytes == bytesOf(out)) << means.threads << " threads, memory " << means.memory;
    }
  }
}

TEST(CellsLoad, PartsComeBackWithTheirShares) {
  const std::string in = marching::temporaryPath("load_in.t4h"), out = marching::temporaryPath("load_out.t4h");
  balls(in, true, fields());
  const hypermesh::File file = open(in);
  CellOptions cells = inCells(file.header().tets / 6);
  cells.targets = targetsOf(file, 5);
  const CellReport report = simplifyTo(out, file, {}, cells, {2});
  const hypermesh::File result = open(out);
  expectSound(result);
  ASSERT_EQ(result.parts().size(), 3u);
  const std::vector<std::uint64_t> left = tetsByPart(result);
  std::uint64_t sum = 0;
  for (std::size_t part = 0; part < 3; ++part) {
    EXPECT_EQ(result.parts()[part].isovalue, file.parts()[part].isovalue);
    EXPECT_LE(left[part], cells.targets[part]);
    EXPECT_GE(static_cast<double>(left[part]), 0.9 * static_cast<double>(cells.targets[part]));
    sum += left[part];
    const auto sliceOf = [part](const hypermesh::File& mesh) {
      return [&mesh, part](double frame) {
        exchange::SliceWants wants;
        wants.part = part;
        return std::move(exchange::sliceHypermesh(mesh, frame, wants).mesh);
      };
    };
    if (left[part] == 0) continue;
    outofcore::ThreadExecutor executor(1);
    outofcore::Progress progress;
    std::vector<double> frames{1, 3.37, 6};
    EXPECT_TRUE(measure::boundSlices(sliceOf(result), sliceOf(file), file.header().index_to_world, file.header().domain,
                                     frames, 1.0, executor, progress)
                    .within);
  }
  EXPECT_EQ(left[2], 0u);
  EXPECT_EQ(report.tets, sum);
}

TEST(CellsLoad, ColumnsAreAsNearAsInCoreAndTheMetricPaysForThem) {
  const std::string in = marching::temporaryPath("load_in.t4h"), plain = marching::temporaryPath("load_plain.t4h"),
                    weighed = marching::temporaryPath("load_weighed.t4h"),
                    core = marching::temporaryPath("load_core.t4h");
  balls(in, false, fields());
  const hypermesh::File file = open(in);
  const Options options = toTets(file.header().tets / 12);
  simplifyTo(plain, file, options, inCells(file.header().tets / 6), {2});
  simplifyTo(weighed, file, options, inCells(file.header().tets / 6), {2}, kWave);
  simplifyTo(core, file, options, inCells(2 * file.header().tets), {2}, kWave);
  expectSound(open(weighed));
  outofcore::Progress progress;
  const std::vector<double> frames{1, 2.37, 4, 6.63};
  const auto rms = [&](const std::string& path, std::size_t column) {
    return measure::compareColumns(open(path), file, frames, progress)[column].rms;
  };
  EXPECT_LT(rms(weighed, 0), 0.8 * rms(plain, 0));
  EXPECT_LT(rms(weighed, 0), 1.25 * rms(core, 0)) << "a whole mesh is one cell";
  // Labels are the input's, what is not known is not made up.
  const hypermesh::File result = open(weighed);
  std::size_t unknown = 0;
  for (std::size_t k = 0; k < result.geometryPages(); ++k) {
    const hypermesh::GatheredPage page = unwrap(result.gather(k));
    const auto label = unwrap(result.gatherColumn(1, k, page.view)),
               hole = unwrap(result.gatherColumn(2, k, page.view));
    for (const float value : label) EXPECT_TRUE(value == 3 || value == 12) << value;
    for (const float value : hole) {
      unknown += std::isnan(value) ? 1 : 0;
      EXPECT_FALSE(value > 12) << value;
    }
  }
  EXPECT_GT(unknown, 10u);
}

// Nothing is collapsed: values go through two scatters and the writer as they are.
TEST(CellsLoad, ValuesOfVerticesThatStayAreKeptToTheBit) {
  const std::string in = marching::temporaryPath("load_in.t4h"), out = marching::temporaryPath("load_out.t4h");
  balls(in, true, fields());
  const hypermesh::File file = open(in);
  Options options;
  options.most_error = 0;
  CellOptions cells = inCells(file.header().tets / 7);
  cells.targets = tetsByPart(file);
  EXPECT_EQ(simplifyTo(out, file, options, cells, {2}, kWave).stats.collapses, 0u);
  const auto valuesOf = [](const hypermesh::File& mesh) {
    std::map<std::array<float, 4>, std::array<std::uint32_t, 3>> values;
    for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
      const hypermesh::GatheredPage page = unwrap(mesh.gather(k));
      for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float> column = unwrap(mesh.gatherColumn(c, k, page.view));
        for (std::size_t v = 0; v < page.view.vertices.size(); ++v) {
          const Vec4f& p = page.view.vertices[v];
          values[{p.x, p.y, p.z, p.t}][c] = std::bit_cast<std::uint32_t>(column[v]);
        }
      }
    }
    return values;
  };
  EXPECT_TRUE(valuesOf(open(out)) == valuesOf(file));
}

// What columns have in the metric is shared out to cells in parts; together they are the whole.
TEST(CellsLoad, SumsInTheMetricAddUpToThoseOfTheMesh) {
  const std::string in = marching::temporaryPath("load_in.t4h"), out = marching::temporaryPath("load_sums");
  balls(in, false, fields());
  const hypermesh::File file = open(in);
  outofcore::Progress progress;
  ReadOptions read;
  read.columns = planColumns(file, std::vector<ColumnWish>{{0, true, 2.5}, {1, false, {}}, {2, true, 1.0}}, progress);
  const SlimMesh mesh = readMesh(file, read, progress);
  ASSERT_EQ(mesh.columns.terms, 2u);
  const outofcore::WorkFolder folder(out, "test", false);
  std::vector<std::uint64_t> ids(mesh.positions.size());
  for (std::size_t v = 0; v < ids.size(); ++v) ids[v] = v;
  writeResult(folder.file("r"), mesh, ids, true, {});
  const CellResult whole = readResult(folder.file("r"), ResultWants::kAll);
  const FixedGrid grid(file.header().bounds);
  std::vector<FixedPlace> sums;
  for (const hypermesh::Tet& tet : mesh.tets) {
    sums.emplace_back();
    for (const std::uint32_t v : tet)
      for (std::size_t axis = 0; axis < 4; ++axis) sums.back()[axis] += grid.placeOf(mesh.positions[v])[axis];
  }
  const CellTree tree(sums, mesh.tets.size(), mesh.tets.size() / 9, Cuts::kThirds, {1, 1, 1, 1});
  ASSERT_GT(tree.cells(), 8u);
  std::vector<SlimColumn> columns;
  for (const PlannedColumn& column : read.columns) columns.push_back(column.as);
  const CellPaths paths(folder, 1, {2, 3});
  const std::vector<CellSize> sizes = scatter([&](const VisitPiece& visit) { visit(whole.piece(1)); }, tree, grid,
                                              ids.size(), loadOf(columns), paths, 1 << 16);
  std::vector<Quadric> squares(ids.size());
  std::vector<double> offsets(2 * ids.size()), weights(2 * ids.size());
  std::size_t shared = 0;
  for (std::size_t cell = 0; cell < sizes.size(); ++cell) {
    const LoadedCell loaded = loadCell(paths, cell, true, columns);
    for (std::size_t v = 0; v < loaded.ids.size(); ++v) {
      const std::uint64_t id = loaded.ids[v];
      shared += (loaded.flags[v] & kLocked) != 0 ? 1 : 0;
      squares[id].add(loaded.columns.squares[v]);
      for (std::size_t j = 0; j < 2; ++j) {
        offsets[2 * id + j] += loaded.columns.sums[2 * v + j].offset;
        weights[2 * id + j] += loaded.columns.sums[2 * v + j].weight;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(loaded.columns.list[c].values[v]),
                  std::bit_cast<std::uint32_t>(mesh.columns.list[c].values[id]));
      }
    }
  }
  EXPECT_GT(shared, 100u);
  for (std::size_t id = 0; id < ids.size(); ++id) {
    EXPECT_EQ(squares[id].xx, mesh.columns.squares[id].xx);
    EXPECT_EQ(squares[id].tt, mesh.columns.squares[id].tt);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_EQ(offsets[2 * id + j], mesh.columns.sums[2 * id + j].offset);
      EXPECT_EQ(weights[2 * id + j], mesh.columns.sums[2 * id + j].weight);
    }
  }
}

TEST(CellsLoad, TheStreamingWriterWritesPartsAndColumnsAsTheOneInCore) {
  const std::string in = marching::temporaryPath("load_in.t4h"), core = marching::temporaryPath("load_core.t4h"),
                    streamed = marching::temporaryPath("load_streamed.t4h");
  balls(in, true, fields());
  const hypermesh::File file = open(in);
  const std::vector<Column> columns{{"wave", 1}, {"label", 1}, {"holes", 1}};
  outofcore::ThreadExecutor executor(1);
  outofcore::Progress progress;
  const outofcore::WorkFolder folder(streamed + ".cells", "test", false);
  std::vector<PackedMesh> packed;
  std::vector<PartResults> results;
  ReadOptions read;
  read.columns = planColumns(file, std::vector<ColumnWish>{{0, false, {}}, {1, false, {}}, {2, false, {}}}, progress);
  for (read.part = 0; read.part < 3; ++read.part) {
    SlimMesh mesh = readMesh(file, read, progress);
    std::vector<std::uint64_t> ids(mesh.positions.size());
    for (std::size_t v = 0; v < ids.size(); ++v) ids[v] = 5 * v + 7;
    simplify(mesh, toTets(mesh.live_tets * 2 / 3), executor, progress);
    const std::string path = folder.file("r" + std::to_string(read.part));
    writeResult(path, mesh, ids, true, {});
    results.push_back({{path}, 0.25 + static_cast<double>(read.part), 0.5});
    packed.push_back(pack(std::move(mesh)));
    packed.back().error_estimated = 0.25F + static_cast<float>(read.part), packed.back().error_measured = 0.5F;
  }
  hypermesh::Writer writer = testing::writerFor(core, file, columns);
  writeMeshes(packed, writer, progress);
  unwrap(writer.close("{}"));
  std::vector<SlimColumn> carried;
  for (const PlannedColumn& column : read.columns) carried.push_back(column.as);
  for (const std::size_t buffer : {std::size_t{1} << 12, std::size_t{1} << 26}) {
    hypermesh::Writer again = testing::writerFor(streamed, file, columns);
    writeResults(results, carried, again, folder, buffer, progress);
    unwrap(again.close("{}"));
    EXPECT_TRUE(bytesOf(core) == bytesOf(streamed)) << buffer;
  }
}

// All begins in one frame, as where nothing moves: pages stay small all the same.
TEST(CellsLoadStiff, PagesOfASceneThatStandsStillStayBounded) {
  constexpr std::uint32_t kSide = 340;
  std::vector<Vec4f> points;
  for (const float t : {0.0F, 1000.0F})
    for (std::uint32_t y = 0; y <= kSide; ++y)
      for (std::uint32_t x = 0; x <= kSide; ++x)
        points.push_back({static_cast<float>(x), static_cast<float>(y), 0.5F, t});
  std::vector<hypermesh::Tet> tets;
  const std::uint32_t layer = (kSide + 1) * (kSide + 1);
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t a = y * (kSide + 1) + x, b = a + 1, c = b + kSide + 1, d = a + kSide + 1;
      for (const auto& [p, q, r] : {std::array{a, b, c}, std::array{a, d, c}}) {
        tets.push_back({p, q, r, r + layer});
        tets.push_back({p, q, r + layer, q + layer});
        tets.push_back({p, q + layer, r + layer, p + layer});
      }
    }
  }
  ASSERT_GT(tets.size(), kMostPageItems);
  const Bounds4f domain{{0, 0, 0, 0}, {kSide, kSide, 1, 1000}};
  const SlimMesh mesh = makeSlimMesh(points, tets, domain, {}, Metric::kSlice);
  const std::string core = marching::temporaryPath("still_core.t4h"), out = marching::temporaryPath("still_out.t4h");
  hypermesh::MeshHeader header{};
  header.domain = domain, header.isovalue = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> times;
  for (int k = 0; k <= 1000; ++k) times.push_back(k);
  const auto create = [&](const std::string& path) {
    return unwrap(hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true));
  };
  outofcore::Progress progress;
  hypermesh::Writer writer = create(core);
  writeMesh(mesh, 0, writer, progress);
  unwrap(writer.close("{}"));
  const outofcore::WorkFolder folder(out + ".cells", "test", false);
  std::vector<std::uint64_t> ids(points.size());
  for (std::size_t v = 0; v < ids.size(); ++v) ids[v] = v;
  writeResult(folder.file("r"), mesh, ids, true, {});
  const PartResults results{{folder.file("r")}};
  hypermesh::Writer streamed = create(out);
  writeResults({&results, 1}, {}, streamed, folder, std::size_t{1} << 22, progress);
  unwrap(streamed.close("{}"));
  EXPECT_TRUE(bytesOf(core) == bytesOf(out));
  const hypermesh::File file = open(out);
  EXPECT_TRUE(file.verify().ok());
  EXPECT_GT(file.geometryPages(), 1u);
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    EXPECT_LE(file.geometryEntry(k).counts[1], kMostPageItems);
    EXPECT_LE(file.geometryEntry(k).counts[2], kMostPageItems);
  }
  EXPECT_LT(writtenPageBytes(points.size(), tets.size()), std::uint64_t{12} << 20);
  const SliceMesh slice = exchange::sliceHypermesh(file, 500);
  EXPECT_EQ(slice.triangles.size(), tets.size() * 4 / 3) << "every prism is cut";
}

// ---- places that are no manifold

// Two balls of which one vertex, and the corners of one triangle, are the same.
void joinedBalls(const std::string& path) {
  marching::MemoryFrames<float> frames({34, 17, 17}, 6, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    const double at = 0.1 * f(k);
    const double a = std::hypot(f(x) - 8 - at, f(y) - 8, f(z) - 8), b = std::hypot(f(x) - 24 - at, f(y) - 8, f(z) - 8);
    return static_cast<float>(6.3 - std::min(a, b));
  });
  hypermesh::Options options;
  options.iso = 0;
  marching::ExtractedMesh mesh = marching::extract(frames, options);
  std::vector<hypermesh::Tet> first, second;
  for (const hypermesh::Tet& tet : mesh.tets) {
    const auto inside = [&](std::uint32_t v) { return mesh.vertices[v].t > 1 && mesh.vertices[v].t < 4; };
    if (std::all_of(tet.begin(), tet.end(), inside)) (mesh.vertices[tet[0]].x > 16 ? second : first).push_back(tet);
  }
  std::map<std::uint32_t, std::uint32_t> becomes{{second.front()[0], first.front()[0]}};
  for (std::size_t i = 0; i < 3; ++i) becomes[second[second.size() / 2][i]] = first[first.size() / 2][i];
  for (hypermesh::Tet& tet : mesh.tets)
    for (std::uint32_t& v : tet)
      if (becomes.count(v) != 0) v = becomes[v];
  mesh.header.flags = 0;
  hypermesh::Writer writer =
      unwrap(hypermesh::Writer::create(path, mesh.header, mesh.times, {}, paged::Codec::kRaw, true));
  outofcore::Progress progress;
  writeMesh(makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, {}, Metric::kSlice, {true, nullptr, nullptr}), 0,
            writer, progress);
  unwrap(writer.close("{}"));
}

SlimMesh keptMesh(const hypermesh::File& file, NonManifold& found) {
  outofcore::Progress progress;
  ReadOptions read;
  read.keep_non_manifold = true;
  return readMesh(file, read, progress, &found);
}

TEST(CellsLoad, WhatIsNoManifoldIsRefusedOrStaysToTheBit) {
  const std::string in = marching::temporaryPath("joined_in.t4h"), out = marching::temporaryPath("joined_out.t4h");
  joinedBalls(in);
  const hypermesh::File file = open(in);
  const Options options = toTets(file.header().tets / 10);
  CellOptions cells = inCells(file.header().tets / 6);
  EXPECT_THROW(simplifyTo(out, file, options, cells), Error);
  EXPECT_FALSE(std::filesystem::exists(out));
  cells.keep_non_manifold = true;
  NonManifold before, after;
  const SlimMesh was = keptMesh(file, before);
  EXPECT_EQ(before.vertices, 4u);
  EXPECT_EQ(before.triangles, 1u);
  for (const std::uint64_t share : {std::uint64_t{6}, std::uint64_t{2}}) {
    cells.cell_tets = file.header().tets / share;
    const CellReport report = simplifyTo(out, file, options, cells, {2});
    EXPECT_LE(report.tets, options.target_tets);
    const SlimMesh is = keptMesh(open(out), after);
    EXPECT_EQ(after.vertices, before.vertices);
    EXPECT_EQ(after.triangles, before.triangles);
    // Their tetrahedra lie in both balls, so that small cells may never have all of them.
    EXPECT_LE(report.non_manifold.vertices, before.vertices);
    if (report.sweeps.back().cells == 1) {
      EXPECT_EQ(report.non_manifold.vertices, before.vertices);
      EXPECT_EQ(report.non_manifold.triangles, before.triangles);
    }
    EXPECT_EQ(report.sweeps.back().cells == 1, share == 2);
    for (std::uint32_t v = 0; v < was.positions.size(); ++v) {
      if ((was.is_boundary[v] & kPinned) == 0) continue;
      bool is_there = false;
      for (std::uint32_t w = 0; w < is.positions.size(); ++w)
        is_there |= (is.is_boundary[w] & kPinned) != 0 && is.positions[w] == was.positions[v];
      EXPECT_TRUE(is_there) << v;
    }
  }
}

}  // namespace
}  // namespace tet4d::qslim4d
