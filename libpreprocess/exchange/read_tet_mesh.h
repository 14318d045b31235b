// Tetrahedral meshes in: VTK .vtu, Medit .mesh, Gmsh .msh (2.2 and 4.1, text), TetGen .node and .ele.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tet4d::exchange {

struct TetMesh {
  std::string path;
  std::vector<std::array<double, 3>> points;       // world
  std::vector<std::array<std::uint32_t, 4>> tets;  // as the file orders them; vertices are below points.size()
  std::vector<double> scalar;                      // one a point if one was asked for
  std::uint64_t other_cells = 0;                   // left out because only tetrahedra were asked for
};

struct TetMeshOptions {
  // A scalar of the points: an array as selectVtkScalar() takes it, or where there is none of the name, the coordinate
  // "x", "y" or "z". Empty: none.
  std::string scalar;
  bool tets_only = false;  // leave out cells that are no tetrahedra; otherwise the first one is an error
};

// Reads a mesh by the file's suffix, whole: 24 bytes a point, 16 a tetrahedron, 8 a scalar. Pieces of a .vtu are put
// one behind the other; points that stand in several are not merged. Of text formats, cells of fewer dimensions (the
// surface) are left out. Throws Error{kBadInput} naming file, array or line: sizes that the file does not hold, an
// index out of range, a cell of another type, a coordinate that is not finite.
TetMesh readTetMesh(const std::string& path, const TetMeshOptions& options);

// Whether a file's suffix is of one of these formats.
bool isTetMeshName(const std::string& path);

}  // namespace tet4d::exchange
