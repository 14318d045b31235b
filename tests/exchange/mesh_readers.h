// Slow readers of the written mesh files, made for tests: they know the formats' texts, not the writers.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tet4d::testing {

struct PlyMesh {
  bool has_doubles = false;
  std::vector<std::array<double, 3>> points, normals;
  std::vector<std::array<std::int32_t, 3>> triangles;
};
// Reads what a PLY header declares; throws std::runtime_error if a byte is missing or left over.
PlyMesh readPly(const std::string& text);

// A DataArray of a VTK XML file with appended raw data: its numbers, as doubles.
struct VtkArray {
  std::string type;
  unsigned components = 1;
  std::vector<double> values;
};
struct VtkFile {
  std::string kind;
  std::map<std::string, std::uint64_t> piece;  // NumberOfPoints …
  std::map<std::string, VtkArray> arrays;      // by name
};
// Throws std::runtime_error if offsets, sizes or the file's end do not fit together.
VtkFile readVtk(const std::string& text);

}  // namespace tet4d::testing
