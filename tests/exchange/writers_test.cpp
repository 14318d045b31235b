// Written meshes, read back by other means: slices as PLY and VTP, whole hypermeshes as VTU and raw pair.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "tests/exchange/mesh_readers.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::cubesBoundary;
using testing::faultOf;
using testing::isClosed;
using testing::PlyMesh;
using testing::randomCells;
using testing::readFile;
using testing::readPly;
using testing::readVtk;
using testing::Scratch;
using testing::SpaceTime;
using testing::volumeOf;
using testing::VtkFile;
using testing::writeSlabs;

const std::vector<double> kTimes{100, 100.5, 102, 103};

AffineMap scaled(double x, double y, double z, std::array<double, 3> origin = {0, 0, 0}) {
  AffineMap map;
  map.origin = origin;
  map.axes = {{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
  return map;
}

// A file of three slabs and the mesh in it.
struct Sample {
  SpaceTime mesh;
  hypermesh::File file;
};

Sample sampleOf(const Scratch& scratch, const AffineMap& map = {}, double odds = 0.5) {
  SpaceTime mesh = cubesBoundary(3, randomCells(3, odds, 11));
  const std::string path = scratch.path("x.t4h");
  writeSlabs(path, mesh, 4, map, kTimes);
  return {std::move(mesh), unwrap(hypermesh::File::open(path))};
}

template <class Triangles, class Points>
double signedVolume(const Triangles& triangles, const Points& points) {
  double sum = 0;
  for (const auto& t : triangles) {
    const auto &p = points[static_cast<std::size_t>(t[0])], &q = points[static_cast<std::size_t>(t[1])],
               &r = points[static_cast<std::size_t>(t[2])];
    sum += p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
  }
  return sum / 6;
}

TEST(SliceHypermesh, PagesGiveTheSliceOfTheWhole) {
  const Scratch scratch;
  const Sample sample = sampleOf(scratch);
  ASSERT_EQ(sample.file.geometryPages(), 3u);
  for (const double frame : {0.0, 0.25, 1.0, 1.5, 2.0, 2.999, 3.0}) {
    const SliceMesh slice = sliceHypermesh(sample.file, frame);
    SliceMesh expected;
    sliceTets(sample.mesh.tets, sample.mesh.vertices, {}, static_cast<float>(frame), 3, expected);
    EXPECT_EQ(slice.triangles.size(), expected.triangles.size()) << frame;
    EXPECT_GT(slice.triangles.size(), 0u) << frame;
    EXPECT_TRUE(isClosed(slice)) << frame;
    EXPECT_NEAR(volumeOf(slice), volumeOf(expected), 1e-4) << frame;
    const std::set<SliceVertexKey> keys(slice.keys.begin(), slice.keys.end());
    EXPECT_EQ(keys.size(), slice.keys.size()) << frame;
    EXPECT_EQ(keys, std::set<SliceVertexKey>(expected.keys.begin(), expected.keys.end())) << frame;
  }
}

TEST(SliceHypermesh, PagesAliveTogetherAreWelded) {
  // Two pages over the same time, divided in space: the left half and the right half of one cube's boundary.
  const Scratch scratch;
  const SpaceTime mesh = cubesBoundary(1, {true});
  const std::string path = scratch.path("two.t4h");
  hypermesh::MeshHeader header{};
  for (const Vec4f& v : mesh.vertices) header.domain.add(v);
  const std::vector<double> times{0, 1};
  auto writer = unwrap(hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true));
  const std::size_t half = mesh.tets.size() / 2;
  unwrap(writer.addPage(mesh.vertices, {}, std::span(mesh.tets).first(half), header.domain));
  const hypermesh::Run all{0, mesh.vertices.size()};
  unwrap(writer.addPage({}, std::span(&all, 1), std::span(mesh.tets).subspan(half), header.domain));
  unwrap(writer.close("{}"));
  const hypermesh::File file = unwrap(hypermesh::File::open(path));
  for (const double frame : {0.0, 0.5, 1.0}) {
    const SliceMesh slice = sliceHypermesh(file, frame);
    SliceMesh expected;
    sliceTets(mesh.tets, mesh.vertices, {}, static_cast<float>(frame), 1, expected);
    EXPECT_EQ(slice.keys, expected.keys) << frame;
    EXPECT_EQ(slice.triangles, expected.triangles) << frame;
    EXPECT_EQ(slice.positions, expected.positions) << frame;
  }
}

TEST(WritePly, WorldPointsTrianglesAndNormals) {
  const Scratch scratch;
  const Sample sample = sampleOf(scratch, scaled(0.5, 2, 4, {10, 20, 30}));
  const SliceMesh slice = sliceHypermesh(sample.file, 1.25);
  for (const bool normals : {false, true}) {
    for (const bool as_double : {false, true}) {
      const std::string path = scratch.path("a.ply");
      writePly(path, worldMesh(slice, sample.file.header().index_to_world, normals),
               {.as_double = as_double, .force = true});
      const PlyMesh ply = readPly(readFile(path));
      EXPECT_EQ(ply.has_doubles, as_double);
      ASSERT_EQ(ply.points.size(), slice.positions.size());
      for (std::size_t i = 0; i < ply.points.size(); ++i) {
        ASSERT_NEAR(ply.points[i][0], 10 + 0.5 * slice.positions[i].x, 1e-5);
        ASSERT_NEAR(ply.points[i][2], 30 + 4.0 * slice.positions[i].z, 1e-5);
      }
      EXPECT_NEAR(signedVolume(ply.triangles, ply.points), 4 * volumeOf(slice), 1e-2);
      ASSERT_EQ(ply.normals.size(), normals ? ply.points.size() : 0);
      for (const auto& n : ply.normals) ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
    }
  }
  const auto again = [&] { writePly(scratch.path("a.ply"), WorldMesh{}, {}); };
  EXPECT_EQ(faultOf(again).code, FaultCode::kIo) << "an existing file is kept";
}

TEST(WriteVtp, SameMeshAsPlyWithItsTime) {
  const Scratch scratch;
  const Sample sample = sampleOf(scratch);
  const WorldMesh mesh = worldMesh(sliceHypermesh(sample.file, 0.5), {}, true);
  writeVtp(scratch.path("a.vtp"), mesh, {.time = 0.1});
  const std::string text = readFile(scratch.path("a.vtp"));
  EXPECT_NE(text.find("Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">0.1</DataArray>"), std::string::npos);
  VtkFile vtp = readVtk(text);
  EXPECT_EQ(vtp.kind, "PolyData");
  EXPECT_EQ(vtp.piece["NumberOfPoints"], mesh.points.size());
  EXPECT_EQ(vtp.piece["NumberOfPolys"], mesh.triangles.size());
  ASSERT_EQ(vtp.arrays["connectivity"].values.size(), 3 * mesh.triangles.size());
  ASSERT_EQ(vtp.arrays["Points"].values.size(), 3 * mesh.points.size());
  EXPECT_EQ(vtp.arrays["Normals"].components, 3u);
  EXPECT_EQ(vtp.arrays["offsets"].values.back(), static_cast<double>(3 * mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(vtp.arrays["connectivity"].values[3 * i + c], mesh.triangles[i][c]);
  }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(vtp.arrays["Points"].values[3 * i + c], mesh.points[i][c]);
  }
}

TEST(WriteSlices, AMirroredMapTurnsTrianglesOver) {
  const Scratch scratch;
  const Sample sample = sampleOf(scratch);
  const SliceMesh slice = sliceHypermesh(sample.file, 1.5);
  const WorldMesh mirrored = worldMesh(slice, scaled(1, -2, 1), true);
  EXPECT_NEAR(signedVolume(mirrored.triangles, mirrored.points), 2 * volumeOf(slice), 1e-4);
  const WorldMesh plain = worldMesh(slice, scaled(1, 2, 1), true);
  for (std::size_t i = 0; i < plain.normals.size(); ++i) {
    ASSERT_NEAR(plain.normals[i].x, mirrored.normals[i].x, 1e-6);
    ASSERT_NEAR(plain.normals[i].y, -mirrored.normals[i].y, 1e-6) << "normals still point outward";
  }
}

TEST(WriteSlices, AFarOriginIsWrittenInDouble) {
  Bounds4f domain;
  domain.add(Vec4f{0, 0, 0, 0});
  domain.add(Vec4f{63, 47, 47, 75});
  EXPECT_FALSE(needsDouble({}, domain));
  EXPECT_FALSE(needsDouble(scaled(0.02, 0.02, 0.02, {-0.6, -0.4, 0.01}), domain));
  EXPECT_TRUE(needsDouble(scaled(1, 1, 1, {500000, 5200000, 0}), domain));  // metres of a map projection
  const Scratch scratch;
  const AffineMap map = scaled(1, 1, 1, {0, 5200000, 0});
  const Sample sample = sampleOf(scratch, map);
  const SliceMesh slice = sliceHypermesh(sample.file, 0.3);
  const WorldMesh mesh = worldMesh(slice, map, true);
  writePly(scratch.path("a.ply"), mesh, {.as_double = needsDouble(map, sample.file.header().domain)});
  const PlyMesh ply = readPly(readFile(scratch.path("a.ply")));
  for (std::size_t i = 0; i < ply.points.size(); ++i)
    ASSERT_EQ(ply.points[i][1] - 5200000, double{slice.positions[i].y});
  EXPECT_EQ(mesh.normals, sliceNormals(slice)) << "a far origin costs normals nothing";
}

TEST(WriteSlices, AnEmptySliceIsAFile) {
  const Scratch scratch;
  writePly(scratch.path("e.ply"), WorldMesh{}, {});
  EXPECT_TRUE(readPly(readFile(scratch.path("e.ply"))).points.empty());
  writeVtp(scratch.path("e.vtp"), WorldMesh{}, {});
  EXPECT_EQ(readVtk(readFile(scratch.path("e.vtp"))).piece["NumberOfPolys"], 0u);
}

TEST(WritePvd, ListsTimesThatReadBackExactly) {
  const Scratch scratch;
  writePvd(scratch.path("s.pvd"), {{0.1, "s_0000.vtp"}, {1e-7, "a&b\"<.vtp"}}, false);
  const std::string text = readFile(scratch.path("s.pvd"));
  EXPECT_NE(text.find("<DataSet timestep=\"0.1\" part=\"0\" file=\"s_0000.vtp\"/>"), std::string::npos) << text;
  EXPECT_NE(text.find("timestep=\"1e-07\" part=\"0\" file=\"a&amp;b&quot;&lt;.vtp\"/>"), std::string::npos) << text;
}

TEST(WriteVtu, HoldsTheWholeHypermesh) {
  const Scratch scratch;
  for (const double y : {2.0, -2.0}) {
    const AffineMap map = scaled(0.5, y, 1, {3, 0, 0});
    const Sample sample = sampleOf(scratch, map);
    writeVtu(scratch.path("a.vtu"), sample.file, true);
    VtkFile vtu = readVtk(readFile(scratch.path("a.vtu")));
    EXPECT_EQ(vtu.kind, "UnstructuredGrid");
    const std::size_t vertices = sample.mesh.vertices.size(), tets = sample.mesh.tets.size();
    ASSERT_EQ(vtu.piece["NumberOfPoints"], vertices);
    ASSERT_EQ(vtu.piece["NumberOfCells"], tets);
    ASSERT_EQ(vtu.arrays["t"].values.size(), vertices);
    ASSERT_EQ(vtu.arrays["Points"].values.size(), 3 * vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      const Vec4f& v = sample.mesh.vertices[i];
      ASSERT_EQ(vtu.arrays["t"].values[i], kTimes[static_cast<std::size_t>(v.t)]);
      ASSERT_EQ(vtu.arrays["Points"].values[3 * i], 3 + 0.5 * v.x);
      ASSERT_EQ(vtu.arrays["Points"].values[3 * i + 1], y * v.y);
    }
    EXPECT_EQ(vtu.arrays["types"].values, std::vector<double>(tets, 10));
    ASSERT_EQ(vtu.arrays["offsets"].values.size(), tets);
    EXPECT_EQ(vtu.arrays["offsets"].values.back(), static_cast<double>(4 * tets));
    const auto& connectivity = vtu.arrays["connectivity"];
    EXPECT_EQ(connectivity.type, "UInt64");
    ASSERT_EQ(connectivity.values.size(), 4 * tets);
    std::multiset<hypermesh::Tet> written, expected(sample.mesh.tets.begin(), sample.mesh.tets.end());
    for (std::size_t i = 0; i < tets; ++i) {
      hypermesh::Tet tet{};
      for (std::size_t c = 0; c < 4; ++c) tet[c] = static_cast<std::uint32_t>(connectivity.values[4 * i + c]);
      if (y < 0) std::swap(tet[2], tet[3]);  // a mirrored map turns them over
      written.insert(tet);
    }
    EXPECT_EQ(written, expected);
  }
}

TEST(WriteHyper, RawPairHoldsTheWholeHypermesh) {
  const Scratch scratch;
  const Sample sample = sampleOf(scratch, scaled(2, -1, 1));
  const std::string path = scratch.path("a.hyper");
  writeHyper(path, sample.file, false);
  const std::string points = readFile(path + ".pts4.f32"), tets = readFile(path + ".tet.i32");
  ASSERT_EQ(points.size(), sample.mesh.vertices.size() * sizeof(Vec4f));
  ASSERT_EQ(tets.size(), sample.mesh.tets.size() * sizeof(hypermesh::Tet));
  EXPECT_EQ(std::memcmp(points.data(), sample.mesh.vertices.data(), points.size()), 0) << "index space, t in frames";
  std::vector<hypermesh::Tet> read(sample.mesh.tets.size());
  std::memcpy(read.data(), tets.data(), tets.size());
  EXPECT_EQ(std::multiset<hypermesh::Tet>(read.begin(), read.end()),
            std::multiset<hypermesh::Tet>(sample.mesh.tets.begin(), sample.mesh.tets.end()));
  EXPECT_EQ(faultOf([&] { writeHyper(path, sample.file, false); }).code, FaultCode::kIo);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch.path("")), {}), 3) << "nothing else is left";
}

TEST(WriteWhole, AnEmptyHypermeshIsAFile) {
  const Scratch scratch;
  const Sample sample = sampleOf(scratch, {}, 0.0);
  ASSERT_TRUE(sample.mesh.tets.empty());
  writeVtu(scratch.path("e.vtu"), sample.file, false);
  EXPECT_EQ(readVtk(readFile(scratch.path("e.vtu"))).piece["NumberOfCells"], 0u);
  writeHyper(scratch.path("e.hyper"), sample.file, false);
  EXPECT_TRUE(readFile(scratch.path("e.hyper.tet.i32")).empty());
  EXPECT_TRUE(sliceHypermesh(sample.file, 1).triangles.empty());
}

}  // namespace
}  // namespace tet4d::exchange
