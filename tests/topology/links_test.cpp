#include "libpreprocess/topology/links.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "libpreprocess/error.h"
#include "tests/topology/space_time_meshes.h"

namespace tet4d::topology {
namespace {

using hypermesh::Tet;
using testing::SpaceTimeMesh;

TEST(Links, ClosedPolytopesHaveSpheresAndCycles) {
  const LinkCheck simplex = checkLinks(testing::simplexBoundary().tets, 5, false);
  EXPECT_TRUE(simplex.ok());
  EXPECT_EQ(simplex.sphere_links, 5u);
  EXPECT_EQ(simplex.cycle_edges, 10u);
  EXPECT_EQ(simplex.largest_star, 4u);
  const LinkCheck cross = checkLinks(testing::crossPolytopeBoundary().tets, 8, false);
  EXPECT_TRUE(cross.ok());
  EXPECT_EQ(cross.sphere_links, 8u);
  EXPECT_EQ(cross.cycle_edges, 24u);
  EXPECT_EQ(cross.edges, 24u);
}

TEST(Links, OneTetrahedronIsABall) {
  const std::vector<Tet> one{{0, 1, 2, 3}};
  const LinkCheck check = checkLinks(one, 5, true);
  EXPECT_TRUE(check.ok());
  EXPECT_EQ(check.disc_links, 4u);
  EXPECT_EQ(check.path_edges, 6u);
  EXPECT_EQ(check.unused_vertices, 1u);
  const LinkCheck closed = checkLinks(one, 4, false);
  EXPECT_EQ(closed.faulty_vertices, 4u);
  EXPECT_FALSE(closed.ok());
}

TEST(Links, AnExtrudedCubeIsBoundedByItsFirstAndLastFrame) {
  const SpaceTimeMesh cube = testing::stillCube(4);
  std::vector<std::uint8_t> may_bound(cube.vertices.size());
  for (std::size_t i = 0; i < may_bound.size(); ++i) may_bound[i] = cube.vertices[i].t == 0 || cube.vertices[i].t == 3;
  const LinkCheck check = checkLinks(cube.tets, may_bound);
  EXPECT_TRUE(check.ok()) << check.faults.front();
  EXPECT_EQ(check.disc_links, 16u);
  EXPECT_EQ(check.sphere_links, 16u);
  EXPECT_EQ(check.path_edges, 2u * 18);
  may_bound.assign(may_bound.size(), 0);
  EXPECT_EQ(checkLinks(cube.tets, may_bound).faulty_vertices, 16u);
}

// Every face lies in two tetrahedra: only the links show that two solids touch in a vertex or along an edge.
TEST(Links, SolidsThatTouchInAVertexOrAnEdgeAreNoManifold) {
  const auto simplex = testing::simplexBoundary().tets;
  for (const std::uint32_t common : {1u, 2u}) {
    std::vector<Tet> both = simplex;
    for (Tet tet : simplex) {
      for (std::uint32_t& v : tet) v = v < common ? v : v + 5 - common;
      both.push_back(tet);
    }
    const LinkCheck check = checkLinks(both, 10 - common, true);
    EXPECT_EQ(check.faulty_vertices, common);
    EXPECT_EQ(check.faulty_edges, common == 2 ? 1u : 0u);
    EXPECT_EQ(check.sphere_links, 10 - 2 * common);
    EXPECT_FALSE(check.ok());
  }
}

TEST(Links, AFaceInThreeTetrahedraIsNoManifold) {
  const std::vector<Tet> fan{{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}};
  const LinkCheck check = checkLinks(fan, 6, true);
  EXPECT_EQ(check.faulty_vertices, 3u);
  EXPECT_EQ(check.faulty_edges, 3u);
}

TEST(Links, ATetrahedronThatIsThereTwiceIsAFault) {
  const std::vector<Tet> twice{{0, 1, 2, 3}, {1, 0, 2, 3}};
  EXPECT_EQ(checkLinks(twice, 4, false).faulty_vertices, 4u);
}

// A cone over a torus: faces and edges are sound, the link of the tip is a torus.
TEST(Links, ATorusIsNoSphere) {
  const std::uint32_t n = 4, tip = n * n, base = tip + 1;
  std::vector<Tet> cone;
  const auto corner = [&](std::uint32_t i, std::uint32_t j) { return i % n * n + j % n; };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      for (const std::uint32_t end : {tip, base}) {
        cone.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), end});
        cone.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1), end});
      }
    }
  }
  const LinkCheck check = checkLinks(cone, n * n + 2, true);
  EXPECT_EQ(check.faulty_edges, 0u);
  EXPECT_EQ(check.sphere_links, std::uint64_t{n} * n);
  EXPECT_EQ(check.faulty_vertices, 2u);
}

TEST(Links, ARepeatedVertexOrOneThatIsNotThere) {
  const std::vector<Tet> repeated{{0, 1, 1, 3}};
  EXPECT_EQ(checkLinks(repeated, 4, true).degenerate_tets, 1u);
  const std::vector<Tet> outside{{0, 1, 2, 9}};
  EXPECT_THROW(checkLinks(outside, 4, true), Error);
}

TEST(Links, AFileIsCheckedInCoreOrRefused) {
  const std::string path = testing::temporaryFile("mesh.t4h");
  const SpaceTimeMesh cube = testing::stillCube(4);
  testing::Pages pages{{8, 16, 32}, std::vector<std::size_t>(cube.tets.size())};
  for (std::size_t i = 0; i < cube.tets.size(); ++i) pages.page_of_tet[i] = i * 3 / cube.tets.size();
  testing::writeFile(path, cube, pages, hypermesh::kOnGrid, testing::farDomain(cube));
  const auto file = unwrap(hypermesh::File::open(path));
  outofcore::Progress progress;
  const LinkCheck check = checkLinks(file, linkCheckBytes(file), progress);
  EXPECT_TRUE(check.ok()) << check.faults.front();
  EXPECT_EQ(check.disc_links, 16u);
  EXPECT_EQ(check.sphere_links, 16u);
  try {
    checkLinks(file, linkCheckBytes(file) - 1, progress);
    FAIL() << "took more memory than allowed";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kOutOfMemory);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tet4d::topology
