#include "libpreprocess/qslim4d/cost_unit.h"

#include <cmath>

namespace tet4d::qslim4d {

double costUnit(const SlimMesh& mesh) {
  const std::size_t stride = mesh.tets.size() / 4096 + 1;
  double weights = 0, lengths2 = 0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); t += stride) {
    const hypermesh::Tet& tet = mesh.tets[t];
    if (tet[0] == kNone) continue;
    const double length = mesh.space.extent(difference(mesh.positions[tet[1]], mesh.positions[tet[0]]));
    weights += mesh.quadrics[tet[0]].weight, lengths2 += length * length;
    ++count;
  }
  const double typical = count > 0 ? weights / static_cast<double>(count) * (lengths2 / static_cast<double>(count)) : 0;
  return std::isnormal(typical) ? std::exp2(-std::ilogb(typical)) : 1;
}

}  // namespace tet4d::qslim4d
