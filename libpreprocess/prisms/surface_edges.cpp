#include "libpreprocess/prisms/surface_edges.h"

#include <algorithm>

namespace tet4d::prisms {

SurfaceEdges surfaceEdges(std::span<const Triangle> triangles) {
  struct Side {
    Edge edge;
    std::uint32_t forward;  // 1 if the triangle runs from low to high
  };
  std::vector<Side> sides;
  sides.reserve(triangles.size() * 3);
  for (const Triangle& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      sides.push_back({{std::min(a, b), std::max(a, b)}, a < b ? 1U : 0U});
    }
  }
  const auto before = [](const Side& a, const Side& b) {
    return a.edge.low != b.edge.low ? a.edge.low < b.edge.low : a.edge.high < b.edge.high;
  };
  std::sort(sides.begin(), sides.end(), before);
  SurfaceEdges result;
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin;
    std::uint32_t forward = 0;
    for (; end < sides.size() && sides[end].edge == sides[begin].edge; ++end) forward += sides[end].forward;
    result.edges.push_back(sides[begin].edge);
    if (end - begin == 1) ++result.open;
    if (end - begin > 2) ++result.over_two;
    if (end - begin == 2 && forward != 1) ++result.misoriented;
    begin = end;
  }
  return result;
}

}  // namespace tet4d::prisms
