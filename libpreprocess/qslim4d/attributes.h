// Columns in the metric: the quadrics they begin with. Private to qslim4d.
#pragma once

#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

// Fills in squares and sums of the mesh's columns whose weight is not 0, from its tetrahedra and the columns' values;
// weighted as the tetrahedra are in the metric, so that both add up to one squared length. The gradient is the one
// along the tetrahedron, of least length where time is measured by the mesh's speed: covariant when time is rescaled. A
// tetrahedron with a value that is not finite says nothing of that component; nor does one without extent in a
// direction of the gradient along it. Throws Error{kUsage} if there are more than kMostTerms components. O(tets).
void addAttributeQuadrics(SlimMesh& mesh, Metric metric);

}  // namespace tet4d::qslim4d
