// Hypermeshes made by hand, with known topology and measures, and a way to cut them into the pages of a file.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/hypermesh.h"

namespace tet4d::testing {

struct SpaceTimeMesh {
  std::vector<Vec4f> vertices;
  std::vector<hypermesh::Tet> tets;
};

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// The eight corners of [-1, 1]^3 (x fastest) and its twelve triangles, counter-clockwise from outside.
std::vector<Vec3f> cubeCorners();
Triangles cubeTriangles();

// Extrudes triangles through time: `at(k)` gives the vertices' places at frame k = 0 .. frames - 1, vertex i of frame k
// gets number k * n + i. Each prism is cut into three tetrahedra by the diagonals of the smaller vertex at the bottom,
// positive for triangles that are counter-clockwise from outside. Ponchio & Hormann 2008, sec. 4.2.
SpaceTimeMesh extrude(const Triangles& triangles, std::size_t frames,
                      const std::function<std::vector<Vec3f>(std::size_t)>& at);

// The cube above, still, at t = 0 .. frames - 1.
SpaceTimeMesh stillCube(std::size_t frames);

// The boundary of a 4-simplex, five tetrahedra, or of the 16-cell of radius 1 at t 0..2, sixteen; outward.
SpaceTimeMesh simplexBoundary();
SpaceTimeMesh crossPolytopeBoundary();

// A box without walls near the mesh but for its first and last time.
Bounds4f farDomain(const SpaceTimeMesh& mesh);

// Writes a mesh as a file. pages: number of geometry pages; owner_ends[p]: where page p's vertices end (ascending, the
// last is the vertex count); page_of_tet: where each tetrahedron goes. Unused frames are added to the times as needed.
struct Pages {
  std::vector<std::uint64_t> owner_ends;
  std::vector<std::size_t> page_of_tet;
};
void writeFile(const std::string& path, const SpaceTimeMesh& mesh, const Pages& pages, std::uint32_t flags,
               const Bounds4f& domain);
// Everything in one page.
void writeFile(const std::string& path, const SpaceTimeMesh& mesh, std::uint32_t flags, const Bounds4f& domain);

// A name in the test's own temporary folder.
std::string temporaryFile(const std::string& name);

}  // namespace tet4d::testing
