// Largest distances against CGAL's bounded-error Hausdorff distance.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include "libpreprocess/measure/surface_distance.h"
#include "tests/measure/triangle_meshes.h"

namespace tet4d::measure {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using testing::Surface;

// Corners of their own: soups are no surfaces to CGAL otherwise.
Mesh meshOf(const Surface& surface) {
  Mesh mesh;
  for (const Triangle& t : surface.triangles) {
    std::array<Mesh::Vertex_index, 3> v;
    for (std::size_t c = 0; c < 3; ++c) {
      const Point3& p = surface.points[t[c]];
      v[c] = mesh.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
    }
    mesh.add_face(v[0], v[1], v[2]);
  }
  return mesh;
}

void compare(const Surface& a, const Surface& b, double tolerance) {
  const double reference =
      CGAL::Polygon_mesh_processing::bounded_error_symmetric_Hausdorff_distance<CGAL::Sequential_tag>(
          meshOf(a), meshOf(b), tolerance);
  outofcore::ThreadExecutor executor(2);
  const SurfaceDistance d = surfaceDistance(a.view(), b.view(), {tolerance, 10'000}, executor);
  EXPECT_NEAR(d.max(), reference, 2 * tolerance);
  EXPECT_LE(d.maxBound() - d.max(), tolerance * 1.0001);
}

TEST(HausdorffCgal, SpheresThatStandApart) {
  compare(testing::sphere({0, 0, 0}, 1, 14), testing::sphere({0.2, 0.1, -0.1}, 1.1, 11), 1e-3);
  compare(testing::sphere({0, 0, 0}, 1, 10), testing::sphere({5, 0, 0}, 1, 10), 1e-3);
}

TEST(HausdorffCgal, ASquareAndAFoldedOne) {
  Surface folded = testing::square(0);
  folded.points[2][2] = 0.7;
  compare(testing::square(0), folded, 1e-4);
}

TEST(HausdorffCgal, RandomTriangles) {
  std::mt19937 random(5);
  for (int round = 0; round < 3; ++round) {
    Surface a = testing::soup(random, 50), b = testing::soup(random, 70);
    for (Surface* s : {&a, &b}) std::erase_if(s->triangles, [](const Triangle& t) { return t[2] == t[0]; });
    compare(a, b, 1e-3);
  }
}

TEST(HausdorffCgalStiff, FlatAndFar) {
  Surface a = testing::sphere({0, 0, 0}, 1, 12), b = testing::sphere({0.25, 0, 0}, 1, 12);
  for (Surface* s : {&a, &b}) {
    for (Point3& p : s->points) p = {1e4 * p[0] + 1e6, p[1], p[2] - 1e6};
  }
  compare(a, b, 1);
}

}  // namespace
}  // namespace tet4d::measure
