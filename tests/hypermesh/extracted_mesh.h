// Runs the extractor into a file and takes the whole mesh into memory, with global vertex numbers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"

namespace tet4d::hypermesh::testing {

struct ExtractedMesh {
  Stats stats;
  MeshHeader header{};
  std::vector<double> times;
  std::vector<Vec4f> vertices;
  std::vector<Tet> tets;
  std::vector<std::array<std::uint64_t, 2>> pages;  // owned vertices, tets
  std::vector<std::uint64_t> page_parts;
  std::vector<std::vector<float>> columns;  // of all vertices, by column
  std::vector<char> bytes;                  // the file
};

// A path for this test process, removed with it.
std::string temporaryPath(const std::string& name);

// Extracts, closes, reopens, verifies the file (structure, checksums, indices, bounds) and gathers every page.
ExtractedMesh extract(exchange::FrameSource& source, const Options& options, std::size_t threads = 1);

// As extract(), and leaves the file at `path`.
ExtractedMesh extractTo(const std::string& path, exchange::FrameSource& source, const Options& options,
                        std::size_t threads = 1);

// 4D cross product of a tetrahedron's edges: along its positive normal, 6 times its 3-volume long.
std::array<double, 4> normalOf(const ExtractedMesh& mesh, const Tet& tet);

// Sum of the tetrahedra's 3-volumes.
double threeVolume(const ExtractedMesh& mesh);

// Enclosed 4-volume by the divergence theorem with the field (x, 0, 0, 0): right if the mesh is closed up to walls of
// constant y, z or t.
double enclosedFourVolume(const ExtractedMesh& mesh);

// Faults of the face test and of the link test together, one a line; empty for a manifold. Vertices that no
// tetrahedron uses are faults here.
std::string manifoldFaults(exchange::FrameSource& source, const Options& options);

}  // namespace tet4d::hypermesh::testing
