// Places that are no manifold: found as the link test finds them, kept to the bit, and no new ones made.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "libpreprocess/error.h"
#include "libpreprocess/qslim4d/non_manifold.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"
#include "tests/qslim4d/closed_slices.h"

namespace tet4d::qslim4d {
namespace {

using hypermesh::Tet;
namespace marching = hypermesh::testing;

// Two balls apart from each other.
marching::ExtractedMesh twoBalls() {
  marching::MemoryFrames<float> frames({26, 13, 13}, 6, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    const double at = 0.1 * f(k);
    const double a = std::hypot(f(x) - 6 - at, f(y) - 6, f(z) - 6), b = std::hypot(f(x) - 18 - at, f(y) - 6, f(z) - 6);
    return static_cast<float>(4.3 - std::min(a, b));
  });
  hypermesh::Options options;
  options.iso = 0;
  return marching::extract(frames, options);
}

// The balls joined in a vertex (0) and along a triangle (1): vertices of the second one become those of the first.
marching::ExtractedMesh joined() {
  marching::ExtractedMesh mesh = twoBalls();
  const auto isSecond = [&](const Tet& tet) { return mesh.vertices[tet[0]].x > 12; };
  std::vector<Tet> first, second;
  for (const Tet& tet : mesh.tets) {
    const auto inside = [&](std::uint32_t v) { return mesh.vertices[v].t > 1 && mesh.vertices[v].t < 4; };
    if (std::all_of(tet.begin(), tet.end(), inside)) (isSecond(tet) ? second : first).push_back(tet);
  }
  std::map<std::uint32_t, std::uint32_t> becomes;
  const auto join = [&](const Tet& from, const Tet& to, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) becomes[from[i]] = to[i];
  };
  join(second.front(), first.front(), 1);
  join(second[second.size() / 2], first[first.size() / 2], 3);
  for (Tet& tet : mesh.tets)
    for (std::uint32_t& v : tet)
      if (becomes.count(v) != 0) v = becomes[v];
  return mesh;
}

SlimMesh slimOf(const marching::ExtractedMesh& mesh, bool keep) {
  return makeSlimMesh(mesh.vertices, mesh.tets, mesh.header.domain, {}, Metric::kSlice, {keep, nullptr, nullptr});
}

using Face = std::array<std::uint32_t, 3>;

std::map<Face, int> crowdedFaces(const std::vector<Tet>& tets) {
  std::map<Face, int> count;
  for (const Tet& tet : tets) {
    for (std::size_t skip = 0; skip < 4; ++skip) {
      Face face{};
      std::size_t n = 0;
      for (std::size_t i = 0; i < 4; ++i)
        if (i != skip) face[n++] = tet[i];
      std::sort(face.begin(), face.end());
      ++count[face];
    }
  }
  std::erase_if(count, [](const auto& entry) { return entry.second <= 2; });
  return count;
}

TEST(NonManifold, IsRefusedByNameUnlessKept) {
  const marching::ExtractedMesh mesh = joined();
  try {
    slimOf(mesh, false);
    FAIL() << "a triangle in four tetrahedra";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault().code, FaultCode::kBadInput);
    EXPECT_NE(error.fault().place.find("triangle"), std::string::npos);
    EXPECT_NE(error.fault().remedy.find("--non-manifold keep"), std::string::npos);
  }
}

TEST(NonManifold, AManifoldHasNoneWhateverItsBoundary) {
  SlimMesh mesh = slimOf(twoBalls(), true);
  const NonManifold found = lockNonManifold(mesh);
  EXPECT_EQ(found.vertices, 0u);
  EXPECT_EQ(found.triangles, 0u);
}

class NonManifoldOrders : public ::testing::TestWithParam<Order> {};
INSTANTIATE_TEST_SUITE_P(All, NonManifoldOrders, ::testing::Values(Order::kPasses, Order::kMultichoice, Order::kHeap));

TEST_P(NonManifoldOrders, PlacesStayAsTheyAreAndTheRestIsSimplified) {
  const marching::ExtractedMesh mesh = joined();
  const topology::LinkCheck before = topology::checkLinks(mesh.tets, mesh.vertices.size(), true);
  const std::map<Face, int> faces = crowdedFaces(mesh.tets);
  ASSERT_EQ(faces.size(), 1u);
  SlimMesh slim = slimOf(mesh, true);
  const NonManifold found = lockNonManifold(slim);
  EXPECT_EQ(found.vertices, before.faulty_vertices);
  EXPECT_EQ(found.vertices, 4u) << "the vertex, and the triangle's corners";
  EXPECT_EQ(found.triangles, 1u);
  std::vector<std::uint32_t> locked;
  for (std::uint32_t v = 0; v < slim.positions.size(); ++v)
    if ((slim.is_boundary[v] & kLocked) != 0) locked.push_back(v);

  Options options;
  options.order = GetParam();
  options.target_tets = mesh.tets.size() / 10;
  outofcore::ThreadExecutor executor(2);
  outofcore::Progress progress;
  const Stats stats = simplify(slim, options, executor, progress);
  EXPECT_FALSE(stats.stalled);
  for (const std::uint32_t v : locked) {
    EXPECT_TRUE(slim.isUsed(v));
    EXPECT_EQ(slim.positions[v], mesh.vertices[v]);
  }
  const std::vector<Tet> left = testing::liveTets(slim);
  EXPECT_EQ(crowdedFaces(left), faces) << "the same triangle in as many tetrahedra, and no other";
  const topology::LinkCheck after = topology::checkLinks(left, slim.positions.size(), true);
  EXPECT_EQ(after.faulty_vertices, before.faulty_vertices);
  EXPECT_EQ(after.faulty_edges, before.faulty_edges);
  EXPECT_EQ(after.degenerate_tets, 0u);
}

}  // namespace
}  // namespace tet4d::qslim4d
