#include "libpreprocess/hypermesh/slab_tets.h"

#include <algorithm>
#include <cassert>

namespace tet4d::hypermesh {

// The loops over cells, in two sets of instructions.
struct SlabLoops {
  using EdgeRow = SlabTets::EdgeRow;
  using Count = SlabTets::Count;

  // Calls visit(x, configuration) for every cell of a row whose sixteen corners are not all alike, 64 cells at a time.
  template <class Visit>
  [[gnu::always_inline]] static inline void forActiveCells(const SlabTets& slab_tets, std::uint64_t y, std::uint64_t z,
                                                           const Visit& visit) {
    const Slab& slab = slab_tets.slab_;
    const GridShape& shape = slab.shape;
    std::array<const std::uint64_t*, 8> rows{};  // row r holds the corners 2r and 2r + 1
    for (std::size_t r = 0; r < 8; ++r) {
      const BitPlane& inside = (r & 4U ? slab.inside_upper : slab.inside_lower).inside;
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
      if (!slab.usable.empty()) active &= slab.usable[shape.rowStart(y, z) + w];
      for (; active; active &= active - 1) {
        const auto bit = static_cast<unsigned>(__builtin_ctzll(active));
        unsigned configuration = 0;
        for (unsigned r = 0; r < 8; ++r)
          configuration |= static_cast<unsigned>((here[r] >> bit & 1U) | (right[r] >> bit & 1U) << 1) << 2 * r;
        visit(w * 64 + bit, configuration);
      }
    }
  }

  [[gnu::always_inline]] static inline Count count(const SlabTets& slab_tets, std::uint64_t z) {
    Count count;
    const std::uint32_t* const offsets = slab_tets.table_.offsets.data();
    for (std::uint64_t y = 0; y + 1 < slab_tets.slab_.shape.dims[1]; ++y) {
      if (slab_tets.isRowAlike(y, z)) continue;
      forActiveCells(
          slab_tets, y, z, [&](std::uint64_t, unsigned configuration) __attribute__((always_inline)) {
            ++count.active_cells;
            count.tets += offsets[configuration + 1] - offsets[configuration];
          });
    }
    return count;
  }

  [[gnu::always_inline]] static inline void emit(const SlabTets& slab_tets, std::uint64_t z, std::span<Tet> out) {
    const CellTable& table = slab_tets.table_;
    std::vector<EdgeRow> rows = slab_tets.edges_;
    std::array<std::uint32_t, 256> local{};  // of the current cell's cut edges
    Tet* next = out.data();
    for (std::uint64_t y = 0; y + 1 < slab_tets.slab_.shape.dims[1]; ++y) {
      if (slab_tets.isRowAlike(y, z)) continue;
      slab_tets.startRow(y, z, rows);
      forActiveCells(
          slab_tets, y, z, [&](std::uint64_t x, unsigned configuration) __attribute__((always_inline)) {
            for (const EdgeDirection& direction : table.directions) {
              unsigned cut = (configuration ^ configuration >> direction.axes) & direction.bases;
              for (; cut; cut &= cut - 1) {
                const std::uint8_t e = direction.number[static_cast<std::size_t>(__builtin_ctz(cut))];
                const EdgeRow& row = rows[e];
                const std::uint64_t base_x = x + row.dx;
                const std::size_t word = row.row + base_x / 64;
                const std::uint64_t below = (std::uint64_t{1} << base_x % 64) - 1;
                local[e] = row.first_local + row.plane->prefix[word] +
                           static_cast<std::uint32_t>(__builtin_popcountll(row.plane->bits[word] & below));
              }
            }
            const CellTet* tet = table.tets.data() + table.offsets[configuration];
            const CellTet* const end = table.tets.data() + table.offsets[configuration + 1];
            for (; tet != end; ++tet)
              *next++ = {local[(*tet)[0]], local[(*tet)[1]], local[(*tet)[2]], local[(*tet)[3]]};
          });
    }
    assert(next == out.data() + out.size());
  }

  static Count countPortable(const SlabTets& slab_tets, std::uint64_t z) { return count(slab_tets, z); }
  TET4D_WIDE static Count countWide(const SlabTets& slab_tets, std::uint64_t z) { return count(slab_tets, z); }
  static void emitPortable(const SlabTets& slab_tets, std::uint64_t z, std::span<Tet> out) { emit(slab_tets, z, out); }
  TET4D_WIDE static void emitWide(const SlabTets& slab_tets, std::uint64_t z, std::span<Tet> out) {
    emit(slab_tets, z, out);
  }
};

SlabTets::SlabTets(const CellTable& table, const Slab& slab, Simd simd)
    : table_(table),
      slab_(slab),
      count_(simd == Simd::kWide ? SlabLoops::countWide : SlabLoops::countPortable),
      emit_(simd == Simd::kWide ? SlabLoops::emitWide : SlabLoops::emitPortable) {
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

// Whether the eight rows of corners are alike, so that no cell between them is active.
bool SlabTets::isRowAlike(std::uint64_t y, std::uint64_t z) const {
  const std::size_t row = slab_.shape.row(y, z), next = slab_.shape.row(y, z + 1);
  const RowState state = slab_.inside_lower.rows[row];
  if (state == RowState::kMixed) return false;
  const auto same = [&](const std::vector<RowState>& rows, std::size_t r) {
    return rows[r] == state && rows[r + 1] == state;
  };
  return same(slab_.inside_lower.rows, row) && same(slab_.inside_lower.rows, next) &&
         same(slab_.inside_upper.rows, row) && same(slab_.inside_upper.rows, next);
}

void SlabTets::startRow(std::uint64_t y, std::uint64_t z, std::span<EdgeRow> rows) const {
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const unsigned base = table_.edges[e].base;
    // An edge of no cell of the row never gets asked for, so the rows beyond the grid need no care.
    rows[e].row = slab_.shape.rowStart(y + (base >> 1 & 1U), z + (base >> 2 & 1U));
  }
}

}  // namespace tet4d::hypermesh
