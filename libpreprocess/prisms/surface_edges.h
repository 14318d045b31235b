// The edges of a triangle mesh, each once, and what is wrong with them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tet4d::prisms {

using Triangle = std::array<std::uint32_t, 3>;

struct Edge {
  std::uint32_t low, high;  // vertices, low < high
  friend bool operator==(const Edge&, const Edge&) = default;
};

struct SurfaceEdges {
  std::vector<Edge> edges;        // sorted
  std::uint64_t open = 0;         // in one triangle
  std::uint64_t over_two = 0;     // in three triangles or more
  std::uint64_t misoriented = 0;  // in two triangles that run along it the same way
};

// O(triangles log triangles), 16 bytes an edge of each triangle beside the result.
SurfaceEdges surfaceEdges(std::span<const Triangle> triangles);
// What it holds at most.
constexpr std::uint64_t surfaceEdgesBytes(std::uint64_t triangles) { return triangles * 3 * (16 + sizeof(Edge)); }

}  // namespace tet4d::prisms
