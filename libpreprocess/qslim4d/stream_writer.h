// Writes a hypermesh from the results of cells, without ever holding it: the same pages as writeMesh() would. Private
// to qslim4d.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/outofcore/work_folder.h"

namespace tet4d::qslim4d {

struct WrittenMesh {
  std::uint64_t vertices = 0, tets = 0;
};

// results: paths, in the order of the cells. Vertices are numbered by time and then by their numbers in the input,
// those that no tetrahedron uses left out; tetrahedra stand by their first vertex and then by cells; pages are whole
// frames. Two external sorts of `buffer_bytes` each, not at a time; beside them a result, and a page as it is written.
// Throws Error{kInterrupted}.
WrittenMesh writeResults(const std::vector<std::string>& results, double error_world, hypermesh::Writer& writer,
                         const outofcore::WorkFolder& folder, std::size_t buffer_bytes, outofcore::Progress& progress);

}  // namespace tet4d::qslim4d
