#include "libpreprocess/measure/triangle_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace tet4d::measure {
namespace {

constexpr std::uint32_t kLeaf = 4;
// Halving leaves at most 31 levels of nodes that wait.
constexpr std::size_t kDepth = 64;

Point3 minus(const Point3& a, const Point3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point3 cross(const Point3& u, const Point3& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

// To the segment from the origin of `p` along `u`.
double squaredToSegment(const Point3& p, const Point3& u) {
  const double length = dot(u, u);
  const double s = length > 0 ? std::clamp(dot(p, u) / length, 0.0, 1.0) : 0;
  const Point3 rest{p[0] - s * u[0], p[1] - s * u[1], p[2] - s * u[2]};
  return dot(rest, rest);
}

double squaredToBox(const Point3& p, const Point3& low, const Point3& high) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double off = std::max({low[c] - p[c], 0.0, p[c] - high[c]});
    sum += off * off;
  }
  return sum;
}

}  // namespace

double squaredDistance(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  const Point3 ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
  const Point3 n = cross(ab, ac);
  const double area = dot(n, n);
  double face = std::numeric_limits<double>::infinity();
  if (area > 0) {
    const double v = dot(cross(ap, ac), n) / area, w = dot(cross(ab, ap), n) / area;
    if (v >= 0 && w >= 0 && v + w <= 1) {
      // The foot is made of the corners, not of n: where n is mostly rounding it is still a point of the triangle.
      const Point3 rest{ap[0] - v * ab[0] - w * ac[0], ap[1] - v * ab[1] - w * ac[1], ap[2] - v * ab[2] - w * ac[2]};
      face = dot(rest, rest);
      if (area > 1e-12 * dot(ab, ab) * dot(ac, ac)) return face;
    }
  }
  return std::min(
      {face, squaredToSegment(ap, ab), squaredToSegment(ap, ac), squaredToSegment(minus(p, b), minus(c, b))});
}

TriangleTree::TriangleTree(const SurfaceView& mesh) {
  std::vector<Corners> all(mesh.triangles.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) all[i][c] = mesh.points[mesh.triangles[i][c]];
  }
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto count = static_cast<std::uint32_t>(all.size());
  nodes_.reserve(std::size_t{2} * (count / (kLeaf / 2) + 1));
  nodes_.emplace_back();
  build(0, 0, count, order, all);
  triangles_.reserve(count);
  for (const std::uint32_t i : order) triangles_.push_back(all[i]);
  ranks_ = std::move(order);
}

void TriangleTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::span<std::uint32_t> order,
                         std::span<const Corners> all) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Node made{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}, first, count};
  Point3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};  // of the middles, each three times as large
  const auto middle = [&](std::uint32_t i, std::size_t c) { return all[i][0][c] + all[i][1][c] + all[i][2][c]; };
  for (const std::uint32_t i : order.subspan(first, count)) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (const Point3& p : all[i]) {
        made.low[c] = std::min(made.low[c], p[c]);
        made.high[c] = std::max(made.high[c], p[c]);
      }
      low[c] = std::min(low[c], middle(i, c));
      high[c] = std::max(high[c], middle(i, c));
    }
  }
  if (count > kLeaf) {
    std::size_t axis = 0;
    for (std::size_t c = 1; c < 3; ++c) axis = high[c] - low[c] > high[axis] - low[axis] ? c : axis;
    // Halves, whatever the middles: the depth stays below 32 where all of them are one.
    const auto begin = order.begin() + first, half = begin + count / 2;
    std::nth_element(begin, half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
      const double x = middle(a, axis), y = middle(b, axis);
      return x != y ? x < y : a < b;
    });
    made.first = static_cast<std::uint32_t>(nodes_.size());
    made.count = 0;
    nodes_.emplace_back();
    nodes_.emplace_back();
    build(made.first, first, count / 2, order, all);
    build(made.first + 1, first + count / 2, count - count / 2, order, all);
  }
  nodes_[node] = made;
}

TriangleTree::Nearest TriangleTree::nearest(const Point3& p, std::uint32_t hint) const {
  struct Waiting {
    std::uint32_t node;
    double squared;
  };
  const Corners& near = triangles_[hint < triangles_.size() ? hint : 0];
  Nearest best{squaredDistance(p, near[0], near[1], near[2]), hint < triangles_.size() ? hint : 0};
  std::array<Waiting, kDepth> stack{};
  std::size_t waiting = 0;
  stack[waiting++] = {0, squaredToBox(p, nodes_[0].low, nodes_[0].high)};
  while (waiting > 0) {
    const Waiting top = stack[--waiting];
    if (top.squared >= best.squared) continue;
    const Node& node = nodes_[top.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const double squared = squaredDistance(p, triangles_[i][0], triangles_[i][1], triangles_[i][2]);
        if (squared < best.squared) best = {squared, i};
      }
      continue;
    }
    Waiting left{node.first, squaredToBox(p, nodes_[node.first].low, nodes_[node.first].high)};
    Waiting right{node.first + 1, squaredToBox(p, nodes_[node.first + 1].low, nodes_[node.first + 1].high)};
    if (left.squared < right.squared) std::swap(left, right);
    stack[waiting++] = left;  // the farther one waits
    stack[waiting++] = right;
  }
  return best;
}

double TriangleTree::covering(std::span<const Point3, 3> corners, double limit) const {
  const auto toNode = [&](std::uint32_t node) {
    double most = 0;
    for (const Point3& p : corners) most = std::max(most, squaredToBox(p, nodes_[node].low, nodes_[node].high));
    return most;
  };
  double best = std::numeric_limits<double>::infinity();
  std::array<std::uint32_t, kDepth> stack{};
  std::size_t waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const std::uint32_t top = stack[--waiting];
    if (toNode(top) >= std::min(best, limit)) continue;
    const Node& node = nodes_[top];
    if (node.count == 0) {
      const bool left_first = toNode(node.first) <= toNode(node.first + 1);
      stack[waiting++] = node.first + (left_first ? 1 : 0);
      stack[waiting++] = node.first + (left_first ? 0 : 1);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      double most = 0;
      for (const Point3& p : corners) {
        most = std::max(most, squaredDistance(p, triangles_[i][0], triangles_[i][1], triangles_[i][2]));
        if (most >= best) break;
      }
      best = std::min(best, most);
    }
  }
  return best;
}

}  // namespace tet4d::measure
