// Slices and whole hypermeshes into foreign mesh files. Every file appears whole or not at all
// (outofcore/output_file.h). All throw Error: kIo or kNoSpace for the output, kBadInput for a damaged input.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/world_mesh.h"

namespace tet4d::exchange {

// PLY, binary little-endian: x y z (float or, if `as_double`, double), nx ny nz if the mesh has normals, triangles.
void writePly(const std::string& path, const WorldMesh& mesh, bool as_double, bool force);

// VTK XML PolyData, appended raw data, 64-bit headers. `time` (world) goes into the field TimeValue.
void writeVtp(const std::string& path, const WorldMesh& mesh, double time, bool as_double, bool force);

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
