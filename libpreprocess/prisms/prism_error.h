// How far the slices of written tetrahedra are from the input's frames: a pass of its own, over what was emitted.
#pragma once

#include <span>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/prisms/prism_pages.h"
#include "libpreprocess/prisms/window.h"

namespace tet4d::prisms {

// The largest distance, at any frame of the window, between a point of the tetrahedra's slice and the point of the
// input it stands for, world units. The slice of a tetrahedron at a frame is affine between the crossings of its edges,
// and so is the input there: the largest distance is at a crossing. tets: as prismPage() made them, before
// nameForeign().
double measurePrisms(const Window& window, std::span<const hypermesh::Tet> tets, const KeptNumbers& numbers,
                     unsigned frame, const WorldLength& length, outofcore::Executor& executor);

}  // namespace tet4d::prisms
