// Tetrahedral meshes in: VTK unstructured grids in every style, and the text formats.
#include <gtest/gtest.h>

#include "libpreprocess/exchange/read_tet_mesh.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "tests/exchange/support.h"
#include "tests/exchange/vtk_samples.h"

namespace tet4d::exchange {
namespace {

using testing::bytesOf;
using testing::faultOf;
using testing::Scratch;
using testing::VtkForm;
using testing::VtkStyle;
using testing::VtkText;

using Points = std::vector<std::array<double, 3>>;
using Tets = std::vector<std::array<std::uint32_t, 4>>;

struct Cells {
  std::vector<std::int64_t> connectivity{0, 1, 2, 3, 1, 2, 3, 4}, offsets{4, 8};
  std::vector<std::uint8_t> types{10, 10};
};

// A piece of five points and two tetrahedra whose scalar is first, first + 1, …
std::string piece(VtkText& text, float first, const Cells& cells = {}) {
  const std::vector<float> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, first, 1, 1};
  std::vector<float> scalar, vector;
  for (int i = 0; i < 5; ++i) {
    scalar.push_back(first + static_cast<float>(i));
    for (int c = 0; c < 3; ++c) vector.push_back(static_cast<float>(c * 10 + i));
  }
  return "<Piece NumberOfPoints=\"5\" NumberOfCells=\"" + std::to_string(cells.types.size()) + "\">\n<PointData>\n" +
         text.array(SampleType::kF32, "p", 1, bytesOf(scalar)) + text.array(SampleType::kF32, "U", 3, bytesOf(vector)) +
         "</PointData>\n<CellData>\n" +
         text.array(SampleType::kU8, "material", 1, std::string(cells.types.size(), '\1')) + "</CellData>\n<Points>\n" +
         text.array(SampleType::kF32, "Points", 3, bytesOf(points)) + "</Points>\n<Cells>\n" +
         text.array(SampleType::kI64, "connectivity", 1, bytesOf(cells.connectivity)) +
         text.array(SampleType::kI64, "offsets", 1, bytesOf(cells.offsets)) +
         text.array(SampleType::kU8, "types", 1, bytesOf(cells.types)) + "</Cells>\n</Piece>\n";
}

std::string grid(const VtkStyle& style, const Cells& cells = {}) {
  VtkText text(style);
  const std::string body = piece(text, 7, cells) + piece(text, 20);
  return text.file("UnstructuredGrid", "<UnstructuredGrid>\n" + body + "</UnstructuredGrid>\n");
}

TEST(TetMesh, VtuInEveryStyle) {
  const Scratch scratch;
  for (const VtkStyle& style : testing::allVtkStyles()) {
    const std::string path = scratch.write("a.vtu", grid(style));
    const TetMesh mesh = readTetMesh(path, {"p", false});
    ASSERT_EQ(mesh.points.size(), 10U) << style.name();
    EXPECT_EQ(mesh.points[9], (std::array<double, 3>{20, 1, 1}));
    EXPECT_EQ(mesh.tets, (Tets{{0, 1, 2, 3}, {1, 2, 3, 4}, {5, 6, 7, 8}, {6, 7, 8, 9}}));
    EXPECT_EQ(mesh.scalar, (std::vector<double>{7, 8, 9, 10, 11, 20, 21, 22, 23, 24}));
    EXPECT_EQ(readTetMesh(path, {"U:2", false}).scalar[6], 21);
    EXPECT_EQ(readTetMesh(path, {"x", false}).scalar[4], 7);
    EXPECT_TRUE(readTetMesh(path, {}).scalar.empty());
  }
}

TEST(TetMesh, OtherCellsAreNamedOrLeftOut) {
  const Scratch scratch;
  Cells cells;
  cells.connectivity = {0, 1, 2, 3, 0, 1, 2, 3, 4, 1, 2, 3, 4};
  cells.offsets = {4, 9, 13};
  cells.types = {10, 14, 10};
  const std::string path = scratch.write("a.vtu", grid({}, cells));
  const Fault fault = faultOf([&] { readTetMesh(path, {}); });
  EXPECT_EQ(fault.place, "cell 1");
  EXPECT_NE(fault.what.find("pyramid"), std::string::npos) << fault.what;
  const TetMesh mesh = readTetMesh(path, {"", true});
  EXPECT_EQ(mesh.tets.size(), 4U);
  EXPECT_EQ(mesh.tets[1], (std::array<std::uint32_t, 4>{1, 2, 3, 4}));
  EXPECT_EQ(mesh.other_cells, 1U);
}

TEST(TetMesh, VtuRefusals) {
  const Scratch scratch;
  const auto messageOf = [&](const Cells& cells, const std::string& scalar = "") {
    const std::string path = scratch.write("a.vtu", grid({VtkForm::kInline}, cells));
    const Fault fault = faultOf([&] { readTetMesh(path, {scalar, false}); });
    EXPECT_EQ(fault.file, path);
    return fault.place + ": " + fault.what + "; " + fault.remedy;
  };
  const auto expect = [](const std::string& message, const std::string& words) {
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  Cells cells;
  cells.connectivity[5] = 99;
  expect(messageOf(cells), "cell 1: vertex id 99, but there are 5 points");
  cells.connectivity[5] = -1;
  expect(messageOf(cells), "\"connectivity\", value 5: is -1");
  cells = {};
  cells.offsets = {4, 4};
  expect(messageOf(cells), "expected");
  cells.offsets = {5, 8};
  expect(messageOf(cells), "cell 0: is a tetrahedron of 5 vertices");
  cells.offsets = {12, 8};
  expect(messageOf(cells), "out of order");
  cells.offsets = {4, std::int64_t{1} << 62};
  expect(messageOf(cells), "\"connectivity\": 4611686018427387904 tuples");
  cells.offsets = {4, 1000};
  expect(messageOf(cells), "are expected");
  expect(messageOf({}, "P"), "has no array \"P\"");
  expect(messageOf({}, "pp"), "did you mean p? The file holds: p, U (3 components), material (of cells)");
  expect(messageOf({}, "U"), "3 components, one is needed");
  expect(messageOf({}, "material"), "of cells, a scalar of points is needed");
}

TEST(TetMesh, OurOwnVtuComesBack) {
  const Scratch scratch;
  const auto cubes = testing::cubesBoundary(3, testing::randomCells(3, 0.4, 5));
  const std::vector<double> times{0, 1, 3, 4};
  testing::writeSlabs(scratch.path("a.t4h"), cubes, 4, {}, times);
  const hypermesh::File file = unwrap(hypermesh::File::open(scratch.path("a.t4h")));
  writeVtu(scratch.path("a.vtu"), file, false);
  const TetMesh mesh = readTetMesh(scratch.path("a.vtu"), {"t", false});
  ASSERT_EQ(mesh.points.size(), file.header().vertices);
  ASSERT_EQ(mesh.tets.size(), file.header().tets);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    EXPECT_EQ(mesh.points[i][1], cubes.vertices[i].y);
    EXPECT_EQ(mesh.scalar[i], times[static_cast<std::size_t>(cubes.vertices[i].t)]);
  }
}

const Points kPoints{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1.5}};
const Tets kTets{{0, 1, 2, 3}, {1, 2, 3, 4}};

constexpr const char* kMedit =
    "MeshVersionFormatted 1\nDimension\n3\n# points\nVertices 5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n1 1 1.5 1\n"
    "Triangles\n1\n1 2 3 7\nTetrahedra\n2\n1 2 3 4 0\n2 3 4 5 0\nEnd\n";
constexpr const char* kGmsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n$Nodes\n5\n10 0 0 0\n"
    "20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1.5\n$EndNodes\n$Elements\n3\n1 2 2 0 1 10 20 30\n2 4 2 0 1 10 20 30 40\n"
    "3 4 0 20 30 40 50\n$EndElements\n";
constexpr const char* kGmsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n2 5 10 50\n"
    "2 1 1 2\n10\n20\n0 0 0 0.5 0.5\n1 0 0 0.5 0.5\n3 1 0 3\n30\n40\n50\n0 1 0\n0 0 1\n1 1 1.5\n$EndNodes\n$Elements\n"
    "2 3 1 3\n2 1 2 1\n1 10 20 30\n3 1 4 2\n2 10 20 30 40\n3 20 30 40 50\n$EndElements\n";
constexpr const char* kNode = "# made by hand\n5 3 1 0\n1 0 0 0 9\n2 1 0 0 9\n3 0 1 0 9\n4 0 0 1 9\n5 1 1 1.5 9\n";
constexpr const char* kEle = "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n";

TEST(TetMesh, TextFormatsHoldTheSameMesh) {
  const Scratch scratch;
  scratch.write("t.node", kNode);
  const std::vector<std::string> paths{scratch.write("a.mesh", kMedit), scratch.write("2.msh", kGmsh2),
                                       scratch.write("4.msh", kGmsh4), scratch.write("t.ele", kEle)};
  for (const std::string& path : paths) {
    const TetMesh mesh = readTetMesh(path, {"z", false});
    EXPECT_EQ(mesh.points, kPoints) << path;
    EXPECT_EQ(mesh.tets, kTets) << path;
    EXPECT_EQ(mesh.scalar[4], 1.5);
    EXPECT_EQ(mesh.other_cells, 0U);
    EXPECT_NE(faultOf([&] { readTetMesh(path, {"p", false}); }).remedy.find("x, y and z"), std::string::npos);
  }
}

TEST(TetMeshHostile, EveryPrefixOfATextIsAnErrorOrTheMesh) {
  const Scratch scratch;
  scratch.write("t.node", kNode);
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"a.mesh", kMedit}, {"2.msh", kGmsh2}, {"4.msh", kGmsh4}, {"t.ele", kEle}}) {
    for (std::size_t length = 0; length + 2 < text.size(); ++length) {
      const std::string path = scratch.write(name, std::string_view(text).substr(0, length));
      try {
        // Medit's "End" is not needed; a last number may be cut short where nothing follows it.
        EXPECT_EQ(readTetMesh(path, {}).tets.size(), 2U) << length;
        EXPECT_GT(length + 8, text.size()) << name;
      } catch (const Error& error) {
        EXPECT_FALSE(error.fault().what.empty());
      }
    }
  }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

TEST(TetMeshHostile, TextRefusals) {
  const Scratch scratch;
  const std::vector<std::array<std::string, 3>> refusals{
      {"a.mesh", replaced(kMedit, "Vertices 5", "Vertices 500000000000"), "500000000000 items are told"},
      {"a.mesh", replaced(kMedit, "Tetrahedra\n2", "Tetrahedra\n-2"), "\"-2\""},
      {"a.mesh", replaced(kMedit, "2 3 4 5 0", "2 3 4 6 0"), "vertex id 5 counted from 0, but there are 5"},
      {"a.mesh", replaced(kMedit, "2 3 4 5 0", "0 3 4 5 0"), "numbered 0"},
      {"a.mesh", replaced(kMedit, "1.5 1", "nan 1"), "not finite"},
      {"a.mesh", replaced(kMedit, "1.5 1", "1,5 1"), "expected a number"},
      {"a.mesh", replaced(kMedit, "Triangles\n1\n1 2 3 7", "Prisms 1 1 2 3 4 5 1 7"), "a prism, not a tetrahedron"},
      {"a.mesh", replaced(kMedit, "Triangles", "Trilobites"), "\"Trilobites\" is not known"},
      {"a.mesh", replaced(kMedit, "Dimension\n3", "Dimension\n2"), "dimension 3"},
      {"a.mesh", "mesh", "expected MeshVersionFormatted"},
      {"a.mesh", std::string("MeshVersionFormatted ") + std::string(5000, '1'), "longer than 1024"},
      {"a.msh", replaced(kGmsh2, "2.2 0", "2.2 1"), "binary"},
      {"a.msh", replaced(kGmsh2, "2.2 0", "1.0 0"), "expected 2.2 or 4.1"},
      {"a.msh", replaced(kGmsh2, "30 40 50", "30 40 60"), "node 60, which is not there"},
      {"a.msh", replaced(kGmsh2, "20 1 0 0", "10 1 0 0"), "node 10 is there twice"},
      {"a.msh", replaced(kGmsh2, "1 2 2 0 1", "1 77 2 0 1"), "type 77"},
      {"a.msh", replaced(kGmsh2, "3 4 0 20 30 40 50", "3 4 99999 20 30 40 50"), "99999 items"},
      {"a.msh", replaced(kGmsh4, "$Nodes\n2 5", "$Nodes\n9 5"), "expected a"},
      {"a.ele", replaced(kEle, "2 4 0", "2 10 0"), "10 nodes, expected 4"},
      {"a.ele", replaced(kEle, "2 2 3 4 5", "2 0 3 4 5"), "vertex 0 is out of range"},
  };
  scratch.write("a.node", kNode);
  for (const auto& [name, text, words] : refusals) {
    const std::string path = scratch.write(name, text);
    const Fault fault = faultOf([&] { readTetMesh(path, {}); });
    const std::string message = fault.place + ": " + fault.what + "; " + fault.remedy;
    EXPECT_NE(message.find(words), std::string::npos) << message << "\n for " << text;
  }
  EXPECT_EQ(faultOf([&] { readTetMesh("a.stl", {}); }).code, FaultCode::kUsage);
}

}  // namespace
}  // namespace tet4d::exchange
