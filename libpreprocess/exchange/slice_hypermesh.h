// The slice of a hypermesh file at a time.
#pragma once

#include "formats/core/slicer.h"
#include "formats/hypermesh.h"

namespace tet4d::exchange {

// The slice at a frame number. Loads only the pages alive at that time: one that begins exactly there, not one that
// ends there, but at the mesh's last time the last one. Keys are global vertex numbers; vertices are welded across
// pages, in order of first use. Throws Error of a damaged page. O(pages at that time).
SliceMesh sliceHypermesh(const hypermesh::File& mesh, double frame);

}  // namespace tet4d::exchange
