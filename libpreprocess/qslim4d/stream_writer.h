// Writes a hypermesh from the results of cells, without ever holding it: the same pages as writeMesh() would. Private
// to qslim4d.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/outofcore/work_folder.h"
#include "libpreprocess/qslim4d/cell_files.h"

namespace tet4d::qslim4d {

struct WrittenMesh {
  std::uint64_t vertices = 0, tets = 0;
};

// What the cells of a part of a file have left.
struct PartResults {
  std::vector<std::string> paths;  // in the order of the cells
  double error_estimated = 0;      // world units, for the page table
  double error_measured = -1;      // -1: not measured
};

// Bytes of sorting a part, beside a result: buffers, and values of vertices that are put in order together.
std::uint64_t sortBytes(std::uint64_t vertices, const VertexLoad& load, std::size_t buffer_bytes);

// Bytes that writing a page takes, of a mesh with so many vertices and tetrahedra; with the codec zstd as many more as
// the page has.
std::uint64_t writtenPageBytes(std::uint64_t vertices, std::uint64_t tets);

// Vertices are numbered by time and then by their numbers in the input, those that no tetrahedron uses left out;
// tetrahedra stand by their first vertex and then by cells. columns: those of the writer, whose values the results
// have. Two external sorts of `buffer_bytes` each, not at a time, with a result beside them; later a page as it is
// written; what is sorted waits in files of the folder. Throws Error{kInterrupted}.
WrittenMesh writeResults(std::span<const PartResults> parts, std::span<const SlimColumn> columns,
                         hypermesh::Writer& writer, const outofcore::WorkFolder& folder, std::size_t buffer_bytes,
                         outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
