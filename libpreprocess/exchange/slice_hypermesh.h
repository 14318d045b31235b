// The slice of a hypermesh file at a time, with the columns that are wanted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/core/slicer.h"
#include "formats/hypermesh.h"
#include "libpreprocess/exchange/slice_columns.h"

namespace tet4d::exchange {

// What a slice is to carry beside its triangles; nothing else is loaded or computed.
struct SliceWants {
  std::vector<std::size_t> columns;   // of mesh.columns()
  bool velocity = false;              // from the tetrahedra (TetVelocity), as a column "velocity"
  std::optional<std::uint64_t> part;  // only the pages of this part
};

struct Slice {
  SliceMesh mesh;
  std::vector<MeshColumn> columns;  // those wanted, in their order, then "velocity"
};

// The slice at a frame number. Loads only the pages alive at that time: one that begins exactly there, not one that
// ends there, but at the mesh's last time the last one. Keys are global vertex numbers; vertices are welded across
// pages, in order of first use. Columns are interpolated as positions are (interpolateColumn). Throws Error of a
// damaged page. O(pages at that time); memory of the slice, one page, its neighbours and the columns wanted of it.
Slice sliceHypermesh(const hypermesh::File& mesh, double frame, const SliceWants& wants);

// As above, without columns.
SliceMesh sliceHypermesh(const hypermesh::File& mesh, double frame);

}  // namespace tet4d::exchange
