// Costs in a unit of which float32 holds enough. Private to qslim4d.
#pragma once

#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

// A power of two that brings costs near 1: they are kept as float32, and a mesh may be measured in units of 1e-12 or
// 1e12. No order and no result changes where they would have had room anyway.
double costUnit(const SlimMesh& mesh);

}  // namespace tet4d::qslim4d
