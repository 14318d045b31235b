// One bit a sample: which are inside, which edges are cut, and from that the number of every vertex without a table of
// vertices. A plane covers one frame, rows of x padded to whole 64-bit words, rows in the order y, then z.
//
// The vertex on the edge at sample (x, y, z) has the number prefix[word] + the set bits below its own in that word.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/hypermesh/cell_table.h"
#include "libpreprocess/hypermesh/sample_kernels.h"
#include "libpreprocess/outofcore/executor.h"

namespace tet4d::hypermesh {

using BitPlane = std::vector<std::uint64_t>;

// The lattice of every frame — its samples, and `pad` layers of outside around them — and how it lies in a plane.
struct GridShape {
  std::array<std::uint64_t, 3> dims{};  // of the lattice
  std::uint64_t pad = 0;
  std::size_t rowWords() const { return (dims[0] + 63) / 64; }
  std::size_t words() const { return rowWords() * dims[1] * dims[2]; }
  std::size_t rows() const { return dims[1] * dims[2]; }
  std::size_t row(std::uint64_t y, std::uint64_t z) const { return z * dims[1] + y; }
  std::size_t rowStart(std::uint64_t y, std::uint64_t z) const { return row(y, z) * rowWords(); }
  std::uint64_t cells() const { return (dims[0] - 1) * (dims[1] - 1) * (dims[2] - 1); }
  std::uint64_t samples(unsigned axis) const { return dims[axis] - 2 * pad; }
  bool isSample(unsigned axis, std::uint64_t index) const { return index >= pad && index < dims[axis] - pad; }
  // Place of a lattice point's sample in its frame.
  std::size_t sample(std::uint64_t x, std::uint64_t y, std::uint64_t z) const {
    return ((z - pad) * samples(1) + (y - pad)) * samples(0) + (x - pad);
  }
  // The bits of word w of a row that stand for x < limit.
  static std::uint64_t bitsBelow(std::uint64_t limit, std::size_t w) {
    const std::uint64_t first = std::uint64_t{w} * 64;
    if (limit <= first) return 0;
    return limit - first >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << (limit - first)) - 1;
  }
};

// Which points of a frame are inside (value >= isovalue), and which rows are alike throughout.
struct SignPlane {
  BitPlane inside;
  std::vector<RowState> rows;
};
SignPlane makeSignPlane(const GridShape& shape);

// What a sign plane holds.
std::uint64_t signPlaneBytes(const GridShape& shape);

// The cut edges of one direction, by base sample.
struct EdgePlane {
  std::uint8_t axes = 0;           // axis mask: x 1, y 2, z 4, t 8
  std::vector<std::uint8_t> used;  // per row: whether it has a cut edge; bits and prefixes of other rows mean nothing
  BitPlane bits;
  std::vector<std::uint32_t> prefix;  // per word: the number of its first vertex within the set

  // Number of the vertex at a set bit; word = rowStart + x / 64.
  std::uint32_t numberOf(std::size_t word, unsigned bit) const {
    const std::uint64_t below = (std::uint64_t{1} << bit) - 1;
    return prefix[word] + static_cast<std::uint32_t>(std::popcount(bits[word] & below));
  }
};

// The vertices inside one frame (F_k), or those between a frame and the next (E_k): one plane after another.
struct EdgeSet {
  std::vector<EdgePlane> planes;
  std::uint64_t count = 0;
};

// The planes of the given directions, empty. `through_time`: those with t, otherwise those without.
EdgeSet makeEdgeSet(const GridShape& shape, std::span<const EdgeDirection> directions, bool through_time);
// What an edge set of `planes` planes holds.
std::uint64_t edgeSetBytes(const GridShape& shape, std::size_t planes);

// Finds and numbers the cut edges from `lower` to `upper` (the same plane for edges inside a frame). `usable`: the
// cells that will be split, empty for all; an edge that belongs to none of them gets no vertex. Throws Error{kBadInput}
// if the set has 2^32 vertices or more. O(rows + words of rows that are not alike) in tasks of one z layer.
void numberCutEdges(const GridShape& shape, const SignPlane& lower, const SignPlane& upper, const BitPlane& usable,
                    outofcore::Executor& executor, Simd simd, EdgeSet& set);

// The cells of the slab between two frames that touch no NaN, by lowest corner; empty if that is all of them. A frame
// without NaN has an empty plane.
BitPlane cellsWithoutNan(const GridShape& shape, const BitPlane& lower_nan, const BitPlane& upper_nan);

// The cells usable in either of two neighbouring slabs. Empty means all.
BitPlane usableInEither(const BitPlane& a, const BitPlane& b);

std::uint64_t countBits(const BitPlane& plane);

// x, y, z of the first set bit; the plane must have one.
std::array<std::uint64_t, 3> firstBit(const GridShape& shape, const BitPlane& plane);

// Bit i of `from` becomes bit i + shift of `to`; all other bits of `to` become 0.
void shiftRow(std::span<const std::uint64_t> from, std::uint64_t shift, std::span<std::uint64_t> to);

}  // namespace tet4d::hypermesh
