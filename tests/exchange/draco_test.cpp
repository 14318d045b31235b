// Draco files against Draco's own decoder: triangles and winding exact, the loss as large as is said and no larger.
#include <draco/compression/decode.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libpreprocess/exchange/write_mesh.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::readFile;
using testing::Scratch;

WorldMesh sampleMesh(const AffineMap& map = {}) {
  const testing::SpaceTime mesh = testing::cubesBoundary(4, testing::randomCells(4, 0.5, 11));
  SliceMesh slice;
  sliceTets(mesh.tets, mesh.vertices, {}, 1.3f, 4, slice);
  WorldMesh world = worldMesh(slice, map, true);
  world.columns = {{"number", 1, {}}, {"wild", 2, {}}};
  for (std::size_t i = 0; i < world.points.size(); ++i) {
    world.columns[0].values.push_back(static_cast<float>(i));
    world.columns[1].values.insert(world.columns[1].values.end(),
                                   {i % 3 == 0 ? std::numeric_limits<float>::quiet_NaN() : 3e38f, 0.1f});
  }
  return world;
}

std::unique_ptr<draco::Mesh> decoded(const std::string& path) {
  const std::string bytes = readFile(path);
  draco::DecoderBuffer in;
  in.Init(bytes.data(), bytes.size());
  auto mesh = draco::Decoder().DecodeMeshFromBuffer(&in);
  EXPECT_TRUE(mesh.ok()) << mesh.status().error_msg();
  return mesh.ok() ? std::move(mesh).value() : nullptr;
}

TEST(WriteDraco, KeepsTrianglesAndTellsItsLoss) {
  const Scratch scratch;
  const WorldMesh mesh = sampleMesh();
  double before = 1e9;
  for (const unsigned bits : {8u, 14u, 20u}) {
    const std::string path = scratch.path("a.drc");
    const WriteLoss loss = writeSlice(path, mesh, {.draco_bits = bits, .force = true});
    const double step = 4.0 / ((1u << bits) - 1);
    EXPECT_GT(loss.position_world, 0) << bits;
    EXPECT_LE(loss.position_world, step / 2 + 1e-6) << bits;
    EXPECT_LT(loss.position_world, before) << bits;
    before = loss.position_world;
    const auto read = decoded(path);
    ASSERT_NE(read, nullptr);
    ASSERT_EQ(read->num_faces(), mesh.triangles.size());
    // The column "number" names each point's vertex, if its quantization is fine enough.
    const draco::PointAttribute* number = read->GetAttributeByUniqueId(2);
    ASSERT_EQ(read->GetAttributeIdByMetadataEntry("name", "number"), 2);
    std::vector<std::array<std::uint32_t, 3>> theirs, ours(mesh.triangles);
    double worst = 0;
    for (std::uint32_t f = 0; f < read->num_faces(); ++f) {
      std::array<std::uint32_t, 3> face{};
      for (std::size_t c = 0; c < 3; ++c) {
        const draco::PointIndex point = read->face(draco::FaceIndex(f))[c];
        float value = 0;
        std::array<float, 3> place{};
        number->GetMappedValue(point, &value);
        read->GetNamedAttribute(draco::GeometryAttribute::POSITION)->GetMappedValue(point, place.data());
        face[c] = static_cast<std::uint32_t>(std::lround(value));
        for (std::size_t axis = 0; axis < 3; ++axis) {
          worst = std::max(worst, std::abs(mesh.points[std::min<std::size_t>(face[c], mesh.points.size() - 1)][axis] -
                                           double{place[axis]}));
        }
      }
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      theirs.push_back(face);
    }
    if (bits < 14) continue;
    for (auto& face : ours) std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    std::sort(theirs.begin(), theirs.end());
    std::sort(ours.begin(), ours.end());
    EXPECT_EQ(theirs, ours) << bits;
    EXPECT_EQ(worst, loss.position_world) << bits;
    EXPECT_LT(loss.normal_degrees, 1) << bits;
    ASSERT_EQ(loss.columns.size(), 2u);
    EXPECT_LE(loss.columns[0].second, 0.5);
    EXPECT_EQ(loss.columns[1].second, 0) << "what no range holds is kept as it is";
  }
}

TEST(WriteDraco, TheSameBytesEachTimeAndFewerThanPly) {
  const Scratch scratch;
  const WorldMesh mesh = sampleMesh();
  writeSlice(scratch.path("a.drc"), mesh, {});
  writeSlice(scratch.path("b.drc"), mesh, {});
  writeSlice(scratch.path("a.ply"), mesh, {});
  EXPECT_EQ(readFile(scratch.path("a.drc")), readFile(scratch.path("b.drc")));
  EXPECT_LT(3 * readFile(scratch.path("a.drc")).size(), readFile(scratch.path("a.ply")).size());
}

TEST(WriteDracoStiff, SheetsThatTouchAFarOriginAndASingleTriangle) {
  const Scratch scratch;
  // Four sheets on one edge, and two that share a vertex only.
  WorldMesh fan;
  for (const auto& p : {std::array<double, 3>{0, 0, 0},
                        {0, 0, 1},
                        {1, 0, 0},
                        {-1, 0, 0},
                        {0, 1, 0},
                        {0, -1, 0},
                        {0, 1, -1},
                        {1, 1, -1}}) {
    fan.points.push_back(p);
  }
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {1, 0, 5}, {0, 6, 7}};
  EXPECT_LT(writeSlice(scratch.path("fan.drc"), fan, {}).position_world, 1e-4);
  EXPECT_EQ(decoded(scratch.path("fan.drc"))->num_faces(), 5u);
  AffineMap far;
  far.origin = {500000, 52000000, 0};
  const WriteLoss loss = writeSlice(scratch.path("far.drc"), sampleMesh(far), {.as_double = true});
  EXPECT_GT(loss.position_world, 0.1) << "float32 has steps of 4 there, and that is said";
  WorldMesh one;
  one.points = {{1, 1, 1}, {2, 1, 1}, {1, 3, 1}};
  one.triangles = {{0, 1, 2}};
  EXPECT_LT(writeSlice(scratch.path("one.drc"), one, {}).position_world, 1e-3);
}

}  // namespace
}  // namespace tet4d::exchange
