// Slow readers of the written mesh files, made for tests: they know the formats' texts, not the writers.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tet4d::testing {

// What a slice's file says, whatever its format.
struct ReadMesh {
  bool has_doubles = false;
  std::vector<std::array<double, 3>> points, normals;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::map<std::string, std::vector<double>> columns;  // by name: components of vertex 0, of vertex 1, …
};
using PlyMesh = ReadMesh;
// Reads what a PLY header declares; throws std::runtime_error if a byte is missing or left over.
PlyMesh readPly(const std::string& text);

// Text formats, word by word.
ReadMesh readOff(const std::string& text);
ReadMesh readObj(const std::string& text);
// Binary STL: three points a triangle, none shared; `normals` are the triangles'.
ReadMesh readStl(const std::string& text);
// glTF 2.0, binary: the mesh of the first node, moved by its translation; attributes by their names. Checks lengths,
// alignment, and the bounds of the positions.
ReadMesh readGlb(const std::string& text);

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
  std::string normals, vectors;                // the active arrays of the points, empty if there are none
};
// Throws std::runtime_error if offsets, sizes or the file's end do not fit together.
VtkFile readVtk(const std::string& text);

}  // namespace tet4d::testing
