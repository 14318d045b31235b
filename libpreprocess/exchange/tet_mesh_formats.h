// The formats behind readTetMesh(), and what they share.
#pragma once

#include <string>

#include "libpreprocess/exchange/read_tet_mesh.h"

namespace tet4d::exchange {

TetMesh readVtu(const std::string& path, const TetMeshOptions& options);
TetMesh readMedit(const std::string& path, const TetMeshOptions& options);
TetMesh readGmsh(const std::string& path, const TetMeshOptions& options);
// .node with its .ele, whichever is named.
TetMesh readTetgen(const std::string& path, const TetMeshOptions& options);

// Throws if point i is not finite.
void checkPoint(const TetMesh& mesh, std::size_t i);
// "x", "y" and "z".
bool isCoordinate(const std::string& name);
// Fills the scalar with a coordinate, for all points.
void takeCoordinate(TetMesh& mesh, const std::string& name);

}  // namespace tet4d::exchange
