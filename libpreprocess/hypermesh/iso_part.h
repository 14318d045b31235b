// One isovalue's surface while it is extracted: signs, cut edges, positions. A part of the hypermesh.
//
// F_k: the vertices inside frame k; E_k: those from frame k to k + 1. The page of slab k owns F_k and E_k.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/hypermesh/bit_planes.h"
#include "libpreprocess/hypermesh/sample_kernels.h"
#include "libpreprocess/hypermesh/slab_tets.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"

namespace tet4d::hypermesh {

class IsoPart {
 public:
  // isovalue: its number in `kernels`. The references must outlive the part.
  IsoPart(const GridShape& shape, const CellTable& table, const SampleKernels& kernels, std::size_t isovalue,
          Simd simd);

  // Frame k's signs live at k modulo 3, its numbers at k modulo 2, those of slab k at k modulo 2.
  SignPlane& signs(std::size_t frame) { return signs_[frame % 3]; }
  const EdgeSet& within(std::size_t frame) const { return within_[frame % 2]; }
  const EdgeSet& between(std::size_t slab) const { return between_[slab % 2]; }

  // Numbers F_k and E_k. usable: the cells that will be split, empty for all.
  void numberWithin(std::size_t frame, const BitPlane& usable, outofcore::Executor& executor);
  void numberBetween(std::size_t slab, const BitPlane& usable, outofcore::Executor& executor);
  void forgetBetween(std::size_t slab) { between_[slab % 2].count = 0; }

  // Positions of F_k, to be the page's first (nextOwn), and of E_k behind them (own). Samples of the frames named.
  void placeWithin(std::size_t frame, const std::byte* samples, outofcore::Executor& executor,
                   outofcore::MemoryBudget& memory);
  void placeBetween(std::size_t slab, const std::byte* lower, const std::byte* upper, outofcore::Executor& executor,
                    outofcore::MemoryBudget& memory);
  // The page's own vertices F_k E_k, and those of F_{k+1}.
  std::span<const Vec4f> own() const { return own_; }
  std::span<const Vec4f> next() const { return next_; }
  // The last page takes in F_{k+1}; otherwise F_{k+1} begins the next page.
  void joinNext(outofcore::MemoryBudget& memory);
  void advance();

  SlabTets slabTets(std::size_t slab, const BitPlane& usable) const;

  static std::uint64_t bytes(const GridShape& shape, const CellTable& table);

 private:
  void place(const EdgeSet& set, std::size_t frame, const std::byte* lower, const std::byte* upper,
             std::vector<Vec4f>& out, outofcore::Executor& executor, outofcore::MemoryBudget& memory);
  Vec4f* placeRow(const EdgePlane& plane, std::uint64_t y, std::uint64_t z, std::size_t frame, const std::byte* lower,
                  const std::byte* upper, Vec4f* out) const;
  Vec4f* placePaddedRow(const EdgePlane& plane, std::uint64_t y, std::uint64_t z, std::size_t frame,
                        const std::byte* lower, const std::byte* upper, Vec4f* out) const;

  const GridShape& shape_;
  const CellTable& table_;
  const SampleKernels& kernels_;
  std::size_t isovalue_;
  Simd simd_;
  std::array<SignPlane, 3> signs_;
  std::array<EdgeSet, 2> within_, between_;
  std::vector<Vec4f> own_, next_;
  outofcore::MemoryBudget::Reservation position_memory_;
};

}  // namespace tet4d::hypermesh
