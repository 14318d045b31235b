#include "libpreprocess/topology/links.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

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

// The index list of a mesh, in core: the oracle of the streamed check.
LinkCheck inCore(const SpaceTimeMesh& mesh, std::uint32_t flags, const Bounds4f& domain) {
  std::vector<std::uint8_t> may_bound;
  for (const Vec4f& v : mesh.vertices) {
    const bool wall = v.x == domain.min.x || v.x == domain.max.x || v.y == domain.min.y || v.y == domain.max.y ||
                      v.z == domain.min.z || v.z == domain.max.z || v.t == domain.min.t || v.t == domain.max.t;
    may_bound.push_back(wall || (flags & hypermesh::kOnGrid) == 0 || (flags & hypermesh::kInnerBoundary) != 0 ? 1 : 0);
  }
  return checkLinks(mesh.tets, may_bound);
}

LinkCheck streamed(const SpaceTimeMesh& mesh, const testing::Pages& pages, std::uint32_t flags, const Bounds4f& domain,
                   std::uint64_t memory_bytes = 0) {
  const std::string path = testing::temporaryFile("mesh.t4h");
  testing::writeFile(path, mesh, pages, flags, domain);
  outofcore::Progress progress;
  outofcore::MemoryBudget memory(memory_bytes);
  const auto file = unwrap(hypermesh::File::open(path));
  std::filesystem::remove(path);  // it stays mapped
  const LinkCheck check = checkLinks(file, memory, progress);
  EXPECT_EQ(memory.used(), 0u);
  return check;
}

void expectSame(const LinkCheck& a, const LinkCheck& b, const std::string& what) {
  EXPECT_EQ(a.vertices, b.vertices) << what;
  EXPECT_EQ(a.unused_vertices, b.unused_vertices) << what;
  EXPECT_EQ(a.sphere_links, b.sphere_links) << what;
  EXPECT_EQ(a.disc_links, b.disc_links) << what;
  EXPECT_EQ(a.faulty_vertices, b.faulty_vertices) << what;
  EXPECT_EQ(a.edges, b.edges) << what;
  EXPECT_EQ(a.cycle_edges, b.cycle_edges) << what;
  EXPECT_EQ(a.path_edges, b.path_edges) << what;
  EXPECT_EQ(a.faulty_edges, b.faulty_edges) << what;
  EXPECT_EQ(a.largest_star, b.largest_star) << what;
  EXPECT_EQ(a.faults, b.faults) << what;
}

// Any tetrahedron in any page, vertices owned anywhere.
testing::Pages dealtAtRandom(const SpaceTimeMesh& mesh, std::size_t count, std::mt19937& random) {
  testing::Pages pages;
  std::uniform_int_distribution<std::uint64_t> end(0, mesh.vertices.size());
  for (std::size_t p = 0; p + 1 < count; ++p) pages.owner_ends.push_back(end(random));
  pages.owner_ends.push_back(mesh.vertices.size());
  std::sort(pages.owner_ends.begin(), pages.owner_ends.end());
  std::uniform_int_distribution<std::size_t> page(0, count - 1);
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) pages.page_of_tet.push_back(page(random));
  return pages;
}

// Two solids that touch in an edge, in a file's order of vertices.
SpaceTimeMesh touching() {
  SpaceTimeMesh mesh = testing::simplexBoundary();
  const auto simplex = mesh;
  for (Tet tet : simplex.tets) {
    for (std::uint32_t& v : tet) v = v < 2 ? v : v + 3;
    mesh.tets.push_back(tet);
  }
  for (std::size_t v = 2; v < 5; ++v) mesh.vertices.push_back(simplex.vertices[v]);
  return mesh;
}

TEST(FileLinks, AreThoseOfTheArrayHoweverItIsCutIntoPages) {
  SpaceTimeMesh holed = testing::stillCube(5);
  for (std::size_t i = 5; i < holed.tets.size(); i += 7)
    std::swap(holed.tets[i], holed.tets.back()), holed.tets.pop_back();
  std::mt19937 random(5);
  for (const SpaceTimeMesh& mesh : {testing::stillCube(4), testing::crossPolytopeBoundary(), touching(), holed}) {
    const Bounds4f domain = testing::farDomain(mesh);
    for (const std::uint32_t flags : {std::uint32_t{hypermesh::kOnGrid}, 0u}) {
      const LinkCheck expected = inCore(mesh, flags, domain);
      for (int round = 0; round < 20; ++round) {
        const testing::Pages pages = dealtAtRandom(mesh, 1 + static_cast<std::size_t>(round) % 7, random);
        expectSame(streamed(mesh, pages, flags, domain), expected, "round " + std::to_string(round));
      }
    }
  }
  EXPECT_GT(inCore(holed, hypermesh::kOnGrid, testing::farDomain(holed)).faults.size(), 3u)
      << "or the words are not compared";
}

testing::Pages slabsOf(const SpaceTimeMesh& mesh, std::size_t frames) {
  testing::Pages pages;
  for (std::size_t k = 1; k < frames; ++k) {
    pages.owner_ends.push_back(k + 1 == frames ? mesh.vertices.size() : k * (mesh.vertices.size() / frames));
    pages.page_of_tet.insert(pages.page_of_tet.end(), mesh.tets.size() / (frames - 1), k - 1);
  }
  return pages;
}

TEST(FileLinksStiff, MemoryDoesNotGrowWithTheNumberOfPages) {
  std::uint64_t few_open = 0;
  for (const std::size_t frames : {6u, 600u}) {
    const SpaceTimeMesh cube = testing::stillCube(frames);
    // The index list of 600 frames alone takes 16 * 36 * 599 bytes; a page with its front fits in far less.
    const std::uint64_t allowed = 64 * 1024 + frames * 2 * 144;
    const LinkCheck check =
        streamed(cube, slabsOf(cube, frames), hypermesh::kOnGrid, testing::farDomain(cube), allowed);
    EXPECT_TRUE(check.ok());
    EXPECT_EQ(check.disc_links, 16u);
    EXPECT_EQ(check.sphere_links, 8 * (frames - 2));
    EXPECT_EQ(check.vertices, cube.vertices.size());
    if (frames == 6) few_open = check.most_open;
    EXPECT_EQ(check.most_open, few_open);
    EXPECT_GT(check.most_open, 0u);
  }
}

TEST(FileLinksStiff, AFrontThatDoesNotFitIsNamedWithWhatWouldDo) {
  const SpaceTimeMesh cube = testing::stillCube(40);
  // Every tetrahedron's vertices are used by the first and the last page: all of it is open to the end.
  testing::Pages pages{{cube.vertices.size(), cube.vertices.size()}, std::vector<std::size_t>(cube.tets.size(), 0)};
  for (std::size_t i = 0; i < cube.tets.size(); ++i) pages.page_of_tet[i] = i % 2;
  const Bounds4f domain = testing::farDomain(cube);
  const std::uint64_t page_alone = 96 * 1024;
  try {
    streamed(cube, pages, hypermesh::kOnGrid, domain, page_alone);
    FAIL() << "took more memory than allowed";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kOutOfMemory);
    EXPECT_NE(error.fault().what.find("open front of the link test after page 0"), std::string::npos)
        << error.fault().what;
  }
  EXPECT_TRUE(streamed(cube, pages, hypermesh::kOnGrid, domain, 1 << 20).ok());
}

}  // namespace
}  // namespace tet4d::topology
