#include "libpreprocess/hypermesh/slab_tets.h"

#include <algorithm>
#include <cassert>

namespace tet4d::hypermesh {

SlabTets::SlabTets(const CellTable& table, const Slab& slab) : table_(table), slab_(slab) {
  for (const CellEdge edge : table.edges) {
    const bool through_time = edge.direction & 8U, in_upper = edge.base & 8U;
    const EdgeSet& set = through_time ? slab.between : in_upper ? slab.upper : slab.lower;
    const std::uint64_t first = through_time ? slab.lower.count : in_upper ? slab.lower.count + slab.between.count : 0;
    const auto plane = std::find_if(set.planes.begin(), set.planes.end(),
                                    [&](const EdgePlane& p) { return p.axes == edge.direction; });
    assert(plane != set.planes.end());
    edges_.push_back({&*plane, 0, static_cast<std::uint32_t>(first), edge.base & 1U});
  }
}

// Calls visit(x, configuration) for every cell of a row whose sixteen corners are not all alike, 64 cells at a time.
template <class Visit>
void SlabTets::forActiveCells(std::uint64_t y, std::uint64_t z, const Visit& visit) const {
  const GridShape& shape = slab_.shape;
  std::array<const std::uint64_t*, 8> rows{};  // row r holds the corners 2r and 2r + 1
  for (std::size_t r = 0; r < 8; ++r) {
    const BitPlane& inside = r & 4U ? slab_.inside_upper : slab_.inside_lower;
    rows[r] = &inside[shape.rowStart(y + (r & 1U), z + (r >> 1 & 1U))];
  }
  const std::size_t words = shape.rowWords();
  for (std::size_t w = 0; w < words; ++w) {
    std::array<std::uint64_t, 8> here{}, right{};
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (std::size_t r = 0; r < 8; ++r) {
      here[r] = rows[r][w];
      right[r] = here[r] >> 1 | (w + 1 < words ? rows[r][w + 1] << 63 : 0);
      any |= here[r] | right[r];
      all &= here[r] & right[r];
    }
    std::uint64_t active = any & ~all & GridShape::bitsBelow(shape.dims[0] - 1, w);
    if (!slab_.usable.empty()) active &= slab_.usable[shape.rowStart(y, z) + w];
    for (; active; active &= active - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(active));
      unsigned configuration = 0;
      for (unsigned r = 0; r < 8; ++r)
        configuration |= static_cast<unsigned>((here[r] >> bit & 1U) | (right[r] >> bit & 1U) << 1) << 2 * r;
      visit(w * 64 + bit, configuration);
    }
  }
}

SlabTets::Count SlabTets::countLayer(std::uint64_t z) const {
  Count count;
  for (std::uint64_t y = 0; y + 1 < slab_.shape.dims[1]; ++y)
    forActiveCells(y, z, [&](std::uint64_t, unsigned configuration) {
      ++count.active_cells;
      count.tets += table_.count(configuration);
    });
  return count;
}

void SlabTets::startRow(std::uint64_t y, std::uint64_t z, std::span<EdgeRow> rows) const {
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const unsigned base = table_.edges[e].base;
    // An edge of no cell of the row never gets asked for, so the rows beyond the grid need no care.
    rows[e].row = slab_.shape.rowStart(y + (base >> 1 & 1U), z + (base >> 2 & 1U));
  }
}

void SlabTets::emitLayer(std::uint64_t z, std::span<Tet> out) const {
  std::vector<EdgeRow> rows = edges_;
  std::array<std::uint32_t, 256> local{};  // of the current cell's cut edges
  Tet* next = out.data();
  for (std::uint64_t y = 0; y + 1 < slab_.shape.dims[1]; ++y) {
    startRow(y, z, rows);
    forActiveCells(y, z, [&](std::uint64_t x, unsigned configuration) {
      for (const EdgeDirection& direction : table_.directions) {
        unsigned cut = (configuration ^ configuration >> direction.axes) & direction.bases;
        for (; cut; cut &= cut - 1) {
          const std::uint8_t e = direction.number[static_cast<std::size_t>(std::countr_zero(cut))];
          const EdgeRow& row = rows[e];
          const std::uint64_t base_x = x + row.dx;
          local[e] = row.first_local + row.plane->numberOf(row.row + base_x / 64, base_x % 64);
        }
      }
      for (const CellTet& tet : table_.of(configuration))
        *next++ = {local[tet[0]], local[tet[1]], local[tet[2]], local[tet[3]]};
    });
  }
  assert(next == out.data() + out.size());
}

}  // namespace tet4d::hypermesh
