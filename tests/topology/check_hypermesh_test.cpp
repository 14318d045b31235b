#include "libpreprocess/topology/check_hypermesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <random>

#include "libpreprocess/error.h"
#include "tests/topology/space_time_meshes.h"

namespace tet4d::topology {
namespace {

using hypermesh::kInnerBoundary;
using hypermesh::kOnGrid;
using testing::Pages;
using testing::SpaceTimeMesh;

class CheckHypermesh : public ::testing::Test {
 protected:
  HypermeshCheck checked(const SpaceTimeMesh& mesh, std::uint32_t flags, const Bounds4f& domain) {
    testing::writeFile(path_, mesh, flags, domain);
    return checkFile();
  }
  HypermeshCheck checked(const SpaceTimeMesh& mesh, const Pages& pages, std::uint32_t flags = kOnGrid) {
    testing::writeFile(path_, mesh, pages, flags, testing::farDomain(mesh));
    return checkFile();
  }
  HypermeshCheck checked(const SpaceTimeMesh& mesh, std::uint32_t flags = kOnGrid) {
    return checked(mesh, flags, testing::farDomain(mesh));
  }
  HypermeshCheck checkFile() {
    outofcore::Progress progress;
    return checkHypermesh(unwrap(hypermesh::File::open(path_)), progress);
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::string path_ = testing::temporaryFile("mesh.t4h");
};

// Pages as marching hypercubes cuts them: a slab owns its first frame's vertices, the last slab also the last frame's.
Pages slabs(const SpaceTimeMesh& mesh, std::size_t frames) {
  Pages pages;
  const std::size_t per_frame = mesh.vertices.size() / frames, tets = mesh.tets.size() / (frames - 1);
  for (std::size_t k = 1; k < frames; ++k) {
    pages.owner_ends.push_back(k + 1 == frames ? mesh.vertices.size() : k * per_frame);
    pages.page_of_tet.insert(pages.page_of_tet.end(), tets, k - 1);
  }
  return pages;
}

TEST_F(CheckHypermesh, AClosedPolytopeIsSound) {
  for (const auto& mesh : {testing::simplexBoundary(), testing::crossPolytopeBoundary()}) {
    SpaceTimeMesh tilted = mesh;  // two of the simplex's tetrahedra lie at one time as they are
    for (Vec4f& v : tilted.vertices) v.t = 2 * v.t + 0.25f * v.x;
    const float low =
        std::min_element(tilted.vertices.begin(), tilted.vertices.end(), [](auto& a, auto& b) { return a.t < b.t; })->t;
    for (Vec4f& v : tilted.vertices) v.t -= low;
    const HypermeshCheck check = checked(tilted, kOnGrid);
    EXPECT_TRUE(check.ok()) << check.faults.front();
    EXPECT_EQ(check.inner_faces, mesh.tets.size() * 2);
    EXPECT_EQ(check.wall_faces + check.inner_boundary_faces + check.unused_vertices, 0u);
    EXPECT_EQ(check.tets, mesh.tets.size());
    EXPECT_EQ(check.vertices, mesh.vertices.size());
  }
}

TEST_F(CheckHypermesh, SlabsMeetAndOnlyTheTimeWallsAreOpen) {
  const std::size_t frames = 5;
  const SpaceTimeMesh cube = testing::stillCube(frames);
  const HypermeshCheck check = checked(cube, slabs(cube, frames));
  EXPECT_TRUE(check.ok()) << check.faults.front();
  EXPECT_EQ(check.wall_faces, 2u * 12);
  EXPECT_EQ(check.inner_faces, (4 * cube.tets.size() - 24) / 2);
  EXPECT_EQ(check.most_open_faces, 12u);  // the cube's triangles at one frame, whatever the number of slabs
}

TEST_F(CheckHypermesh, ReservesAPageAndItsFrontWhateverTheNumberOfSlabs) {
  std::uint64_t peak_of_few = 0;
  for (const std::size_t frames : {6u, 300u}) {
    const SpaceTimeMesh cube = testing::stillCube(frames);
    testing::writeFile(path_, cube, slabs(cube, frames), kOnGrid, testing::farDomain(cube));
    outofcore::Progress progress;
    outofcore::MemoryBudget memory;
    EXPECT_TRUE(checkHypermesh(unwrap(hypermesh::File::open(path_)), progress, &memory).ok());
    EXPECT_EQ(memory.used(), 0u);
    if (frames == 6) peak_of_few = memory.peak();
    EXPECT_LE(memory.peak(), peak_of_few + frames * 2 * 144) << "but for the ranges that pages share";
    outofcore::MemoryBudget half(memory.peak() / 2);
    EXPECT_THROW(checkHypermesh(unwrap(hypermesh::File::open(path_)), progress, &half), Error);
  }
}

// The front is found from the pages alone: any tetrahedron in any page, vertices owned anywhere.
TEST_F(CheckHypermesh, CountsDoNotDependOnThePages) {
  const SpaceTimeMesh cube = testing::stillCube(4);
  SpaceTimeMesh faulty = cube;
  std::swap(faulty.tets[7][0], faulty.tets[7][1]);
  faulty.tets.push_back(faulty.tets[20]);
  faulty.tets.erase(faulty.tets.begin() + 50);
  faulty.vertices.push_back({0, 0, 0, 2.5f});
  std::mt19937 random(12345);
  for (const SpaceTimeMesh& mesh : {cube, faulty}) {
    const HypermeshCheck whole = checked(mesh);
    for (int round = 0; round < 20; ++round) {
      const std::size_t count = 2 + random() % 6;
      Pages pages;
      for (std::size_t p = 0; p + 1 < count; ++p) pages.owner_ends.push_back(random() % (mesh.vertices.size() + 1));
      pages.owner_ends.push_back(mesh.vertices.size());
      std::sort(pages.owner_ends.begin(), pages.owner_ends.end());
      for (std::size_t i = 0; i < mesh.tets.size(); ++i) pages.page_of_tet.push_back(random() % count);
      const HypermeshCheck cut = checked(mesh, pages);
      EXPECT_EQ(cut.inner_faces, whole.inner_faces);
      EXPECT_EQ(cut.wall_faces, whole.wall_faces);
      EXPECT_EQ(cut.inner_boundary_faces, whole.inner_boundary_faces);
      EXPECT_EQ(cut.faces_over_two, whole.faces_over_two);
      EXPECT_EQ(cut.misoriented_faces, whole.misoriented_faces);
      EXPECT_EQ(cut.unused_vertices, whole.unused_vertices);
      EXPECT_EQ(cut.ok(), whole.ok());
    }
  }
}

TEST_F(CheckHypermesh, AMissingTetrahedronOpensFourFaces) {
  SpaceTimeMesh cube = testing::stillCube(4);
  // Of the middle slab, so that none of its faces lies on the first or last time.
  cube.tets.erase(cube.tets.begin() + static_cast<std::ptrdiff_t>(cube.tets.size() / 2));
  const HypermeshCheck check = checked(cube);
  EXPECT_EQ(check.inner_boundary_faces, 4u);
  ASSERT_FALSE(check.ok());
  EXPECT_NE(check.faults[0].find("lies in one tetrahedron"), std::string::npos);
  EXPECT_LT(check.faults.size(), 4u);  // a few in words, the count says how many
  // The same mesh is legal where inner boundary is announced, or where there is no grid.
  for (const std::uint32_t flags : {kOnGrid | kInnerBoundary, 0u}) {
    const HypermeshCheck legal = checked(cube, flags);
    EXPECT_TRUE(legal.ok());
    EXPECT_EQ(legal.inner_boundary_faces, 4u);
  }
}

TEST_F(CheckHypermesh, ATurnedTetrahedronIsMisorientedOnItsInnerFaces) {
  SpaceTimeMesh cube = testing::stillCube(4);
  auto& tet = cube.tets[cube.tets.size() / 2];
  std::swap(tet[0], tet[1]);
  const HypermeshCheck check = checked(cube);
  EXPECT_EQ(check.misoriented_faces, 4u);
  EXPECT_EQ(check.inner_faces, (4 * cube.tets.size() - 24) / 2);
  EXPECT_FALSE(check.ok());
}

TEST_F(CheckHypermesh, AnEvenPermutationIsNoFault) {
  SpaceTimeMesh cube = testing::stillCube(3);
  for (auto& tet : cube.tets) tet = {tet[1], tet[2], tet[0], tet[3]};
  EXPECT_TRUE(checked(cube).ok());
}

TEST_F(CheckHypermesh, ATetrahedronThatIsThereTwiceOverfillsItsFaces) {
  SpaceTimeMesh cube = testing::stillCube(4);
  cube.tets.push_back(cube.tets[cube.tets.size() / 2]);
  const HypermeshCheck check = checked(cube);
  EXPECT_EQ(check.faces_over_two, 4u);
  EXPECT_FALSE(check.ok());
}

TEST_F(CheckHypermesh, ARepeatedVertexIsRefusedWithItsPage) {
  SpaceTimeMesh cube = testing::stillCube(3);
  cube.tets.push_back({0, 1, 1, 9});
  EXPECT_THROW(checked(cube), Error);
}

TEST_F(CheckHypermesh, TetrahedraWithoutVolumeAreCountedAndLegal) {
  SpaceTimeMesh cube = testing::stillCube(4);
  cube.vertices[9] = cube.vertices[8];  // one edge of the cube at frame 1 shrinks to nothing
  const HypermeshCheck check = checked(cube);
  std::uint64_t with_both = 0;
  for (const auto& tet : cube.tets) {
    with_both += std::count(tet.begin(), tet.end(), 8) + std::count(tet.begin(), tet.end(), 9) == 2 ? 1 : 0;
  }
  EXPECT_GT(with_both, 0u);
  EXPECT_EQ(check.degenerate_tets, with_both);
  EXPECT_TRUE(check.ok());
}

TEST_F(CheckHypermesh, ATetrahedronAtOneTimeIsCountedAndLegal) {
  // One of the simplex's five lies at t = 0; marching hypercubes makes such where a whole region changes sign at once.
  const HypermeshCheck check = checked(testing::simplexBoundary());
  EXPECT_EQ(check.flat_time_tets, 1u);
  EXPECT_EQ(check.inner_faces, 10u);
  EXPECT_TRUE(check.ok());
}

TEST_F(CheckHypermesh, WallsAreThoseOfTheDomain) {
  // An open tube: the cube without its two faces of smallest and largest x, against walls at or beyond x = -1 and 1.
  auto triangles = testing::cubeTriangles();
  triangles.resize(8);  // the last four lie at x = -1 and x = 1
  const SpaceTimeMesh tube = testing::extrude(triangles, 3, [](std::size_t) { return testing::cubeCorners(); });
  Bounds4f domain = testing::farDomain(tube);
  EXPECT_FALSE(checked(tube, kOnGrid, domain).ok());
  domain.min.x = -1, domain.max.x = 1;
  const HypermeshCheck check = checked(tube, kOnGrid, domain);
  EXPECT_TRUE(check.ok()) << check.faults.front();
  EXPECT_EQ(check.wall_faces, 2u * 8 + 2u * (8 * 2));  // two times, and eight edges of the tube in two slabs
  // A face whose vertices lie on different walls lies on none.
  domain.min.x = -100, domain.max.x = 100;
  EXPECT_EQ(checked(tube, kOnGrid, domain).inner_boundary_faces, 2u * (8 * 2));
}

TEST_F(CheckHypermesh, UnusedVerticesAreCountedAndLegal) {
  SpaceTimeMesh cube = testing::stillCube(3);
  cube.vertices.insert(cube.vertices.end(), 3, Vec4f{0, 0, 0, 1});
  const HypermeshCheck check = checked(cube);
  EXPECT_EQ(check.unused_vertices, 3u);
  EXPECT_TRUE(check.ok());
}

TEST_F(CheckHypermesh, AnEmptyMeshIsSound) {
  const SpaceTimeMesh empty;
  const HypermeshCheck check = checked(empty, kOnGrid, {{0, 0, 0, 0}, {1, 1, 1, 1}});
  EXPECT_TRUE(check.ok());
  EXPECT_EQ(check.tets + check.inner_faces + check.wall_faces, 0u);
}

}  // namespace
}  // namespace tet4d::topology
