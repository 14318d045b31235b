#include "libpreprocess/hypermesh/cell_table.h"

namespace tet4d::hypermesh {

int determinant4(const std::array<std::array<int, 4>, 4>& rows) {
  const auto &a = rows[0], &b = rows[1], &c = rows[2], &d = rows[3];
  // Laplace expansion by the 2x2 minors of the upper and the lower pair of rows.
  const auto upper = [&](std::size_t i, std::size_t j) { return a[i] * b[j] - a[j] * b[i]; };
  const auto lower = [&](std::size_t i, std::size_t j) { return c[i] * d[j] - c[j] * d[i]; };
  return upper(0, 1) * lower(2, 3) - upper(0, 2) * lower(1, 3) + upper(0, 3) * lower(1, 2) + upper(1, 2) * lower(0, 3) -
         upper(1, 3) * lower(0, 2) + upper(2, 3) * lower(0, 1);
}

std::vector<EdgeDirection> numberEdges(std::span<const std::uint8_t> axis_masks, std::vector<CellEdge>& edges) {
  std::vector<EdgeDirection> directions;
  for (const std::uint8_t axes : axis_masks) {
    EdgeDirection direction{axes, 0, {}};
    for (std::uint8_t base = 0; base < 16; ++base) {
      if (base & axes) continue;
      direction.bases = static_cast<std::uint16_t>(direction.bases | 1u << base);
      direction.number[base] = static_cast<std::uint8_t>(edges.size());
      edges.push_back({axes, base});
    }
    directions.push_back(direction);
  }
  return directions;
}

}  // namespace tet4d::hypermesh
