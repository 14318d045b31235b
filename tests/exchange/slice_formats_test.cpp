// Slices in every format, read back by readers that know the formats' texts only.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "tests/exchange/mesh_readers.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::readFile;
using testing::ReadMesh;
using testing::Scratch;

AffineMap mapOf(std::array<double, 3> origin) {
  AffineMap map;
  map.origin = origin;
  map.axes = {{{0.5, 0, 0}, {0, 2, 0}, {0, 0, 4}}};
  return map;
}

// A slice with normals and columns whose names are not as formats want them.
WorldMesh sampleMesh(std::array<double, 3> origin = {0, 0, 0}) {
  const testing::SpaceTime mesh = testing::cubesBoundary(3, testing::randomCells(3, 0.5, 11));
  SliceMesh slice;
  sliceTets(mesh.tets, mesh.vertices, {}, 1.25f, 3, slice);
  WorldMesh world = worldMesh(slice, mapOf(origin), true);
  world.normals[5] = {0, 0, 0};
  world.columns = {{"velocity", 3, {}}, {"wind speed", 1, {}}, {"wind_speed", 1, {}}, {"<\"&\n>", 2, {}}, {"x", 1, {}}};
  for (std::size_t i = 0; i < world.points.size(); ++i) {
    const auto k = static_cast<float>(i);
    world.columns[0].values.insert(world.columns[0].values.end(), {k, k + 0.25f, -k});
    world.columns[1].values.push_back(k / 3);
    world.columns[2].values.push_back(2 * k);
    world.columns[3].values.insert(world.columns[3].values.end(), {k, 1});
    world.columns[4].values.push_back(-k);
  }
  return world;
}

std::string pathOf(const Scratch& scratch, std::string name, const MeshFormat& format) {
  return scratch.path(name.append(format.suffix));
}

ReadMesh readBack(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension(), text = readFile(path);
  if (suffix == ".ply") return testing::readPly(text);
  if (suffix == ".off") return testing::readOff(text);
  if (suffix == ".obj") return testing::readObj(text);
  if (suffix == ".stl") return testing::readStl(text);
  if (suffix == ".glb") return testing::readGlb(text);
  const testing::VtkFile vtk = testing::readVtk(text);
  ReadMesh mesh;
  mesh.has_doubles = vtk.arrays.at("Points").type == "Float64";
  for (const auto& [name, array] : vtk.arrays) {
    const auto& v = array.values;
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
      if (name == "Points") mesh.points.push_back({v[i], v[i + 1], v[i + 2]});
      if (name == vtk.normals) mesh.normals.push_back({v[i], v[i + 1], v[i + 2]});
      if (name == "connectivity") {
        mesh.triangles.push_back({static_cast<int>(v[i]), static_cast<int>(v[i + 1]), static_cast<int>(v[i + 2])});
      }
    }
    if (name != "Points" && name != "connectivity" && name != "offsets" && name != vtk.normals) mesh.columns[name] = v;
  }
  return mesh;
}

TEST(SliceFormats, GiveBackPointsTrianglesAndNormals) {
  const Scratch scratch;
  const WorldMesh mesh = sampleMesh();
  for (const MeshFormat& format : meshFormats()) {
    if (format.suffix == ".drc") continue;  // not exact: draco_test.cpp
    for (const bool as_double : {false, true}) {
      const std::string path = pathOf(scratch, "a", format);
      writeSlice(path, mesh, {.as_double = as_double, .force = true});
      const ReadMesh read = readBack(path);
      ASSERT_EQ(read.triangles.size(), mesh.triangles.size()) << path;
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
          const auto& point = read.points[static_cast<std::size_t>(read.triangles[i][c])];
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const double exact = mesh.points[mesh.triangles[i][c]][axis];
            if (as_double && format.doubles) {
              ASSERT_EQ(point[axis], exact) << path;
            } else {  // text is the shortest that reads back as float32
              ASSERT_EQ(static_cast<float>(point[axis]), static_cast<float>(exact)) << path;
            }
          }
        }
      }
      if (format.suffix == ".stl") continue;
      ASSERT_EQ(read.points.size(), mesh.points.size()) << path;
      ASSERT_EQ(read.normals.size(), mesh.normals.size()) << path;
      for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const bool zero = i == 5;  // glTF wants unit ones
        ASSERT_EQ(static_cast<float>(read.normals[i][0]), mesh.normals[i].x) << path;
        ASSERT_EQ(static_cast<float>(read.normals[i][2]), zero && format.suffix == ".glb" ? 1 : mesh.normals[i].z)
            << path;
      }
    }
  }
}

TEST(SliceFormats, GiveBackColumnsUnderNamesTheyCanHold) {
  const Scratch scratch;
  const WorldMesh mesh = sampleMesh();
  writeSlice(scratch.path("a.ply"), mesh, {});
  writeSlice(scratch.path("a.vtp"), mesh, {});
  writeSlice(scratch.path("a.glb"), mesh, {});
  const auto column = [](const ReadMesh& read, const std::string& name) { return read.columns.at(name); };
  const ReadMesh ply = readBack(scratch.path("a.ply")), vtp = readBack(scratch.path("a.vtp")),
                 glb = readBack(scratch.path("a.glb"));
  EXPECT_EQ(ply.columns.size(), 3u + 1 + 1 + 2 + 1);
  EXPECT_EQ(vtp.columns.size(), 5u);
  EXPECT_EQ(glb.columns.size(), 5u);
  const auto same = [](const std::vector<double>& read, const std::vector<float>& values) {
    return std::equal(read.begin(), read.end(), values.begin(), values.end());
  };
  for (const ReadMesh* read : {&vtp, &glb}) {
    const bool upper = read == &glb;
    EXPECT_TRUE(same(column(*read, upper ? "_VELOCITY" : "velocity"), mesh.columns[0].values));
    EXPECT_TRUE(same(column(*read, upper ? "_WIND_SPEED" : "wind speed"), mesh.columns[1].values));
    EXPECT_TRUE(same(column(*read, upper ? "_WIND_SPEED_" : "wind_speed"), mesh.columns[2].values));
    EXPECT_TRUE(same(column(*read, upper ? "______" : "&lt;&quot;&amp;_&gt;"), mesh.columns[3].values));
    EXPECT_TRUE(same(column(*read, upper ? "_X" : "x"), mesh.columns[4].values));
  }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    ASSERT_EQ(column(ply, "velocity_y")[i], double{mesh.columns[0].values[3 * i + 1]});
    ASSERT_EQ(column(ply, "wind_speed")[i], double{mesh.columns[1].values[i]});
    ASSERT_EQ(column(ply, "wind_speed_")[i], double{mesh.columns[2].values[i]});
    ASSERT_EQ(column(ply, "______y")[i], 1);
    ASSERT_EQ(column(ply, "x_")[i], double{mesh.columns[4].values[i]}) << "x is the coordinate";
  }
  const testing::VtkFile vtk = testing::readVtk(readFile(scratch.path("a.vtp")));
  EXPECT_EQ(vtk.normals, "Normals");
  EXPECT_EQ(vtk.vectors, "velocity");
}

TEST(SliceFormats, FacetNormalsOfStlFollowTheWinding) {
  const Scratch scratch;
  const WorldMesh mesh = sampleMesh();
  writeSlice(scratch.path("a.stl"), mesh, {});
  const ReadMesh read = readBack(scratch.path("a.stl"));
  for (std::size_t i = 0; i < read.triangles.size(); ++i) {
    const auto &p = read.points[3 * i], &q = read.points[3 * i + 1], &r = read.points[3 * i + 2];
    const double nz = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    EXPECT_GE(nz * read.normals[i][2], -1e-12);
    const auto& n = read.normals[i];
    EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-6);
  }
}

TEST(SliceFormatsStiff, AFarOriginIsKeptOrItsLossIsTold) {
  const Scratch scratch;
  const std::array<double, 3> origin{500000, 52000000, 0};
  const WorldMesh mesh = sampleMesh(origin);
  for (const MeshFormat& format : meshFormats()) {
    if (format.suffix == ".drc") continue;
    const std::string path = pathOf(scratch, "far", format);
    const WriteLoss loss = writeSlice(path, mesh, {.as_double = true, .origin = origin});
    double worst = 0;
    const ReadMesh read = readBack(path);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          worst = std::max(worst, std::abs(read.points[static_cast<std::size_t>(read.triangles[i][c])][axis] -
                                           mesh.points[mesh.triangles[i][c]][axis]));
        }
      }
    }
    EXPECT_EQ(loss.position_world, worst) << path;
    if (format.suffix == ".stl") {
      EXPECT_GT(worst, 0.1) << "float32 has steps of 4 there";
    } else {
      EXPECT_LT(worst, 1e-6) << path;
    }
  }
}

TEST(SliceFormats, AnEmptySliceIsAFileAndAnExistingOneIsKept) {
  const Scratch scratch;
  for (const MeshFormat& format : meshFormats()) {
    const std::string path = pathOf(scratch, "e", format);
#ifndef TET4D_WITH_DRACO
    if (format.suffix == ".drc") {
      EXPECT_EQ(faultOf([&] { writeSlice(path, WorldMesh{}, {}); }).code, FaultCode::kUsage);
      continue;
    }
#endif
    WorldMesh empty;
    empty.columns = {{"velocity", 3, {}}};
    writeSlice(path, empty, {});
    if (format.suffix != ".drc") {
      EXPECT_TRUE(readBack(path).triangles.empty());
    }
    const std::string before = readFile(path);
    EXPECT_EQ(faultOf([&] { writeSlice(path, sampleMesh(), {}); }).code, FaultCode::kIo) << path;
    EXPECT_EQ(readFile(path), before);
  }
  EXPECT_EQ(faultOf([&] { writeSlice(scratch.path("a.xyz"), {}, {}); }).code, FaultCode::kUsage);
}

}  // namespace
}  // namespace tet4d::exchange
