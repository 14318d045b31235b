// The triangle of a mesh that is nearest to a point: exact in double, by a tree of boxes over the triangles.
//
// A tree and not a grid: its memory is that of the triangles whatever their shapes, and needles a million times as long
// as wide, or a speck beside a plain, cost it no cells.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tet4d::measure {

using Point3 = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;

// A view of a mesh. Triangles index into points, all in range; they may be without area and share no vertex.
struct SurfaceView {
  std::span<const Point3> points;
  std::span<const Triangle> triangles;
};

// Squared distance of p to the triangle (a, b, c), which may be a segment or a point. No square overflows or vanishes
// if coordinates lie within 1e-70 and 1e70 of each other.
double squaredDistance(const Point3& p, const Point3& a, const Point3& b, const Point3& c);

class TriangleTree {
 public:
  // Copies the triangles' corners: 76 bytes a triangle, and up to 64 for its part of the tree. O(n log n). The mesh has
  // at least one triangle and at most 2^31.
  explicit TriangleTree(const SurfaceView& mesh);

  struct Nearest {
    double squared = 0;          // distance
    std::uint32_t triangle = 0;  // in the tree's order: a hint for the next search
  };
  // O(log n) where the mesh is near, O(n) at worst. hint: a triangle that is likely near.
  Nearest nearest(const Point3& p, std::uint32_t hint = 0) const;
  // Where a triangle of the tree's order stands in the mesh.
  std::uint32_t original(std::uint32_t triangle) const { return ranks_[triangle]; }
  // The least over triangles t of the largest distance, squared, of `corners` to t. As distance to t is convex, no
  // point of the corners' hull is farther from the mesh. Searched below `limit`; more than `limit` means it found none.
  double covering(std::span<const Point3, 3> corners, double limit) const;

 private:
  struct Node {
    Point3 low, high;
    std::uint32_t first = 0;  // leaf: of triangles; else the left child, the right one follows it
    std::uint32_t count = 0;  // of triangles; 0: not a leaf
  };
  using Corners = std::array<Point3, 3>;

  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::span<std::uint32_t> order,
             std::span<const Corners> all);

  std::vector<Corners> triangles_;
  std::vector<std::uint32_t> ranks_;  // in the mesh, of each of them
  std::vector<Node> nodes_;
};

}  // namespace tet4d::measure
