// What the tests of exchange share: a folder of their own, errors as values, slices' measures, a hypermesh of cubes.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/slicer.h"
#include "formats/hypermesh.h"
#include "libpreprocess/error.h"

namespace tet4d::testing {

// A folder that is there as long as the test.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, std::string_view content) const;  // returns the path

 private:
  std::filesystem::path folder_;
};

std::string readFile(const std::string& path);

// The fault that `body` throws; a test failure and an empty fault if it throws none.
Fault faultOf(const std::function<void()>& body);

// Six times the enclosed volume is exact in double for small integers; positive if triangles wind outward.
double volumeOf(const SliceMesh& mesh);
double areaOf(const SliceMesh& mesh);
// True if every directed edge has its opposite as often as itself.
bool isClosed(const SliceMesh& mesh);
// Triangles with the same three corners as an earlier one.
std::size_t repeatedTriangles(const SliceMesh& mesh);

struct SpaceTime {
  std::vector<Vec4f> vertices;
  std::vector<hypermesh::Tet> tets;  // positive
};

// The boundary of a union of unit 4-cubes (each cut into 24 simplices by Kuhn) of the grid [0, n]^4. filled: n^4 flags,
// x fastest, t slowest. Vertices are the grid's (n + 1)^4 points, x fastest.
SpaceTime cubesBoundary(std::uint32_t n, const std::vector<bool>& filled);

// Random flags, each true with the odds.
std::vector<bool> randomCells(std::uint32_t n, double odds, std::uint32_t seed);

// A column of all vertices of a mesh.
struct VertexColumn {
  std::string name;
  std::uint32_t components;
  std::vector<float> values;
};

// Writes a mesh whose vertices are ordered by integer time as a file of unit time slabs, as marching hypercubes does:
// page k owns the vertices at time k (the last page those at its end too), with one run of foreign vertices.
void writeSlabs(const std::string& path, const SpaceTime& mesh, std::uint32_t frames, const AffineMap& map,
                std::span<const double> times, const std::vector<VertexColumn>& columns = {});

}  // namespace tet4d::testing
