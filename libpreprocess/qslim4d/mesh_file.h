// A hypermesh file as meshes in core, one for each part.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/progress.h"
#include "libpreprocess/qslim4d/non_manifold.h"
#include "libpreprocess/qslim4d/packed_mesh.h"
#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

// Bytes that simplifying a mesh in core holds at most.
std::uint64_t simplifyBytes(std::uint64_t vertices, std::uint64_t tets);

// What is to become of a column.
struct ColumnWish {
  std::size_t column = 0;  // of file.columns()
  bool in_metric = false;
  // World units that a change by one counts as; without it the column's whole range counts as ten mean cells.
  std::optional<double> weight;
};

// A column as it was found in the whole file: kind, range and weight. No values.
struct PlannedColumn {
  std::size_t column = 0;
  SlimColumn as;
};

struct ReadOptions {
  Metric metric = Metric::kSlice;
  std::uint64_t part = 0;
  bool keep_non_manifold = false;
  std::vector<PlannedColumn> columns;
  outofcore::Executor* executor = nullptr;  // without one, all is done by the caller
};

// Bytes that simplifying `file` holds at most: the mesh, its edges, the columns, and the pages as they are read.
std::uint64_t boundMemory(const hypermesh::File& file, std::span<const ColumnWish> columns = {});

// Reads the columns wished for once (phase "columns", if there are any): a column of whole numbers only is of labels
// unless it is in the metric; three components called "normal" are a normal. Constant columns leave the metric. Throws
// Error of a damaged page.
std::vector<PlannedColumn> planColumns(const hypermesh::File& file, std::span<const ColumnWish> wishes,
                                       outofcore::Progress& progress);

// A part of `file`, or the whole of one without parts (phase "read"), with columns. found: what is no manifold, if
// that is kept. Throws Error{kBadInput} if the file has 2^32 - 1 vertices or 2^30 tetrahedra and more, or a tetrahedron
// a vertex of another part; Error of a damaged page; what makeSlimMesh() and addAttributeQuadrics() throw.
SlimMesh readMesh(const hypermesh::File& file, const ReadOptions& options, outofcore::Progress& progress,
                  NonManifold* found = nullptr);

// Tetrahedra of each part of `file`, one number for a file without parts. Reads the pages of a file with parts.
std::vector<std::uint64_t> tetsByPart(const hypermesh::File& file);

}  // namespace tet4d::qslim4d
