// Test data with a known answer: closed surfaces that move linearly between frames, as files of dynamic triangles.
//
// Built here from first principles and not by libpreprocess, so that the player's tests do not depend on the builder.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/dynamic_triangles.h"

namespace tet4d::test {

struct Surface {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
};

// The unit sphere as an icosahedron with every triangle cut in four `subdivisions` times.
Surface icosphere(int subdivisions);

struct Page {
  std::vector<Vec4f> vertices;
  std::vector<dyntri::Edge> edges;
  std::vector<dyntri::Lifespan> lifespans;
  std::vector<dyntri::Triangle> triangles;
  dyntri::PageView view() const { return {vertices, edges, lifespans, triangles}; }
};

// Where vertex `p` of the surface is at a frame, index space.
using Motion = std::function<std::array<double, 3>(const std::array<double, 3>& p, double frame)>;

// The prisms between frames first .. last of the moving surface, each cut into three tetrahedra, as one page.
Page sweep(const Surface& surface, const Motion& motion, int first, int last);

// A sphere in index space: centre = start + t * velocity, radius = start_radius + t * growth.
struct MovingSphere {
  std::array<double, 3> start{0, 0, 0}, velocity{0, 0, 0};
  double start_radius = 1, growth = 0;
  std::array<double, 3> centreAt(double t) const;
  double radiusAt(double t) const { return start_radius + t * growth; }
  Motion motion() const;
};

// A column of a test file: its rows are computed from the vertices.
struct TestColumn {
  Column column;
  std::function<std::vector<float>(const Vec4f&)> row;
};

struct FileSpec {
  AffineMap map;
  std::vector<double> times;
  paged::Codec codec = paged::Codec::kRaw;
  std::vector<TestColumn> columns = {};
  std::vector<double> part_isovalues = {};  // none: the file is one part
  std::vector<std::uint64_t> part_of_page = {};
};

// A directory of this process, removed when it ends: tests of one name may run at the same time.
const std::string& temporaryDirectory();

// Writes the pages and returns the path, in temporaryDirectory().
std::string writeFile(const std::string& name, const std::vector<Page>& pages, const FileSpec& spec);
std::string writeViews(const std::string& name, std::span<const dyntri::PageView> pages, const FileSpec& spec);

// A sphere of radius 4 -> 6 cells that moves from (8, 8, 8) by (1, 0.5, 0) a frame over `frames` frames; one page
// between two frames; 642 vertices a frame.
inline constexpr MovingSphere kTestSphere{{8, 8, 8}, {1, 0.5, 0}, 4, 0.5};
std::string writeTestSphere(const std::string& name, int frames, const AffineMap& map = {});

// The same with columns "speed [m/s]" (100 x + 10 t; NaN where t = 0), "velocity" (1, 0.5, 0 times t) and "normal" (the
// ideal sphere's).
std::string writeColumnSphere(const std::string& name, int frames);
// Three spheres side by side, each a part, of isovalues 0.1, 0.5 and none.
std::string writeParts(const std::string& name);

}  // namespace tet4d::test
