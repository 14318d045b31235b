// Slices and whole hypermeshes into foreign mesh files. Every file appears whole or not at all
// (outofcore/output_file.h). All throw Error: kIo or kNoSpace for the output, kBadInput for a damaged input.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/world_mesh.h"

namespace tet4d::exchange {

// What a slice's file is told beside its mesh.
struct MeshFileOptions {
  double time = 0;                        // world; kept by .vtp and .glb
  bool as_double = false;                 // needsDouble(): float32 would be too coarse
  std::array<double, 3> origin{0, 0, 0};  // of the map; .glb's float32 coordinates start there if as_double
  unsigned draco_bits = 14;               // 1..30, of .drc
  bool force = false;
};

// A format of slices and what it can hold.
struct MeshFormat {
  std::string_view suffix;
  bool normals, columns, doubles;
};
// Those of writeSlice(), in the order messages name them.
std::span<const MeshFormat> meshFormats();
// The one of a file's suffix, or null.
const MeshFormat* meshFormatOf(const std::string& path);

// What writing cost in exactness.
struct WriteLoss {
  double position_world = 0;  // largest distance along an axis between a point and what the file says of it
  double normal_degrees = 0;  // largest angle between a normal and what the file says
  std::vector<std::pair<std::string, double>> columns;  // largest difference of a component; .drc only
};

// Writes a slice in the format of its suffix, which must be one of meshFormats(). Same mesh, same bytes. O(mesh).
WriteLoss writeSlice(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);

// PLY, binary little-endian: x y z (float or, if as_double, double), nx ny nz if the mesh has normals, a property a
// component of each column (name, or name_x … name_w), triangles.
void writePly(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);

// VTK XML PolyData, appended raw data, 64-bit headers. The time goes into the field TimeValue; normals and a velocity
// are the active normals and vectors.
void writeVtp(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);

// OFF (NOFF with normals) and OBJ: text, the shortest that reads back to the same float or double.
void writeOff(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);
void writeObj(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);

// STL, binary: float32, each triangle with its own normal (zero for one without area).
void writeStl(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);

// glTF 2.0, binary: one node with one mesh, POSITION, NORMAL and an attribute _NAME a column, u32 indices; axes as they
// are, the time in the scene's extras. If as_double, coordinates are from `origin`, which the node's translation adds.
// glTF wants unit normals: where there is none, +z stands. Throws Error{kBadInput} above 4 GiB, the format's end.
void writeGlb(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);

// Draco (.drc), if the build has it, else Error{kUsage}: positions and columns quantized to draco_bits of their range,
// normals to four fewer, a column with numbers of 1e37 and above or without numbers kept as it is. Vertices are
// numbered anew. The file is decoded again: its triangles are compared, and the loss is measured, not estimated.
// Memory: some four times the mesh.
WriteLoss writeDraco(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options);

// ParaView's series: times and the names of their files, relative to the .pvd.
void writePvd(const std::string& path, const std::vector<std::pair<double, std::string>>& steps, bool force);

// The whole hypermesh as tetrahedra: points in world coordinates, float64 point array `t` in world time. Tetrahedra
// keep their orientation in index space, turned over where the map mirrors. Three passes, memory of one page and its
// neighbours.
void writeVtu(const std::string& path, const hypermesh::File& mesh, bool force);

// The raw pair PATH.pts4.f32 (x y z t, index space and frames) and PATH.tet.i32, little-endian, without headers.
// Throws if a vertex number does not fit in int32. One pass, memory of one page and its neighbours.
void writeHyper(const std::string& path, const hypermesh::File& mesh, bool force);

}  // namespace tet4d::exchange
