#include "libpreprocess/hypermesh/bit_planes.h"

#include <algorithm>
#include <string>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::hypermesh {
namespace {

enum Axis : unsigned { kX = 0, kY = 1, kZ = 2 };

// Each bit becomes itself or its lower neighbour along the axis; beyond the grid all is 0. In place: from the far end.
void spreadFromLower(const GridShape& shape, unsigned axis, BitPlane& plane) {
  const std::size_t row = shape.rowWords();
  if (axis == kX) {
    for (std::size_t start = 0; start < plane.size(); start += row)
      for (std::size_t w = row; w-- > 0;)
        plane[start + w] |= plane[start + w] << 1 | (w > 0 ? plane[start + w - 1] >> 63 : 0);
    return;
  }
  const std::size_t step = axis == kY ? row : row * shape.dims[1];
  for (std::size_t i = plane.size(); i-- > step;) {
    const bool first_in_layer = axis == kY && i / row % shape.dims[1] == 0;
    if (!first_in_layer) plane[i] |= plane[i - step];
  }
}

// The same with the upper neighbour.
void spreadFromUpper(const GridShape& shape, unsigned axis, BitPlane& plane) {
  const std::size_t row = shape.rowWords();
  if (axis == kX) {
    for (std::size_t start = 0; start < plane.size(); start += row)
      for (std::size_t w = 0; w < row; ++w)
        plane[start + w] |= plane[start + w] >> 1 | (w + 1 < row ? plane[start + w + 1] << 63 : 0);
    return;
  }
  const std::size_t step = axis == kY ? row : row * shape.dims[1];
  for (std::size_t i = 0; i + step < plane.size(); ++i) {
    const bool last_in_layer = axis == kY && i / row % shape.dims[1] == shape.dims[1] - 1;
    if (!last_in_layer) plane[i] |= plane[i + step];
  }
}

// Clears the bits that are not the lowest corner of a cell.
void keepCells(const GridShape& shape, BitPlane& plane) {
  const std::size_t row = shape.rowWords();
  for (std::uint64_t z = 0; z < shape.dims[2]; ++z)
    for (std::uint64_t y = 0; y < shape.dims[1]; ++y) {
      const bool has_cells = z + 1 < shape.dims[2] && y + 1 < shape.dims[1];
      const std::size_t start = shape.rowStart(y, z);
      for (std::size_t w = 0; w < row; ++w)
        plane[start + w] &= has_cells ? GridShape::bitsBelow(shape.dims[0] - 1, w) : 0;
    }
}

// The edges of a direction that belong to a usable cell: those of its cells along the axes the edge does not take.
BitPlane edgesOfCells(const GridShape& shape, const BitPlane& usable, unsigned axes) {
  BitPlane edges = usable;
  for (unsigned axis = kX; axis <= kZ; ++axis)
    if (!(axes >> axis & 1U)) spreadFromLower(shape, axis, edges);
  return edges;
}

// The cut edges of one row; returns how many. Rows that are alike and equal at both ends are not looked at.
[[gnu::always_inline]] inline std::uint64_t cutRow(const GridShape& shape, const SignPlane& lower,
                                                   const SignPlane& upper, std::uint64_t y, std::uint64_t z,
                                                   EdgePlane& plane) {
  const unsigned dx = plane.axes & 1U, dy = plane.axes >> 1 & 1U, dz = plane.axes >> 2 & 1U;
  if (y + dy >= shape.dims[1] || z + dz >= shape.dims[2]) return 0;
  const std::size_t from = shape.row(y, z), to = shape.row(y + dy, z + dz);
  if (lower.rows[from] == upper.rows[to] && lower.rows[from] != RowState::kMixed) return 0;
  const std::size_t words = shape.rowWords();
  const std::uint64_t* a = &lower.inside[from * words];
  const std::uint64_t* b = &upper.inside[to * words];
  std::uint64_t* out = &plane.bits[from * words];
  std::uint64_t count = 0;
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t next = w + 1 < words ? b[w + 1] : 0;
    const std::uint64_t tip = dx ? b[w] >> 1 | next << 63 : b[w];
    out[w] = (a[w] ^ tip) & GridShape::bitsBelow(shape.dims[0] - dx, w);
    count += static_cast<std::uint64_t>(__builtin_popcountll(out[w]));
  }
  return count;
}

// Keeps the edges of a row that belong to a usable cell; returns how many.
std::uint64_t keepWanted(const GridShape& shape, std::size_t row, const BitPlane& wanted, EdgePlane& plane) {
  std::uint64_t count = 0;
  for (std::size_t w = row * shape.rowWords(); w < (row + 1) * shape.rowWords(); ++w)
    count += static_cast<std::uint64_t>(std::popcount(plane.bits[w] &= wanted[w]));
  return count;
}

struct CutTask {
  const GridShape& shape;
  const SignPlane& lower;
  const SignPlane& upper;
  const std::vector<BitPlane>& wanted;  // by plane, empty for all
};

// The cut edges of plane number p in one layer; returns how many.
[[gnu::always_inline]] inline std::uint64_t cutLayer(const CutTask& task, std::size_t p, std::uint64_t z,
                                                     EdgePlane& plane) {
  std::uint64_t sum = 0;
  for (std::uint64_t y = 0; y < task.shape.dims[1]; ++y) {
    const std::size_t row = task.shape.row(y, z);
    std::uint64_t count = cutRow(task.shape, task.lower, task.upper, y, z, plane);
    if (count != 0 && !task.wanted.empty()) count = keepWanted(task.shape, row, task.wanted[p], plane);
    plane.used[row] = count != 0;
    sum += count;
  }
  return sum;
}

// Writes the numbers of a layer's vertices, from `number` on.
[[gnu::always_inline]] inline void numberLayer(const GridShape& shape, std::uint64_t z, std::uint64_t number,
                                               EdgePlane& plane) {
  for (std::uint64_t y = 0; y < shape.dims[1]; ++y) {
    if (plane.used[shape.row(y, z)] == 0) continue;
    const std::size_t begin = shape.rowStart(y, z);
    for (std::size_t w = begin; w < begin + shape.rowWords(); ++w) {
      plane.prefix[w] = static_cast<std::uint32_t>(number);
      number += static_cast<std::uint64_t>(__builtin_popcountll(plane.bits[w]));
    }
  }
}

std::uint64_t cutLayerPortable(const CutTask& task, std::size_t p, std::uint64_t z, EdgePlane& plane) {
  return cutLayer(task, p, z, plane);
}
TET4D_WIDE std::uint64_t cutLayerWide(const CutTask& task, std::size_t p, std::uint64_t z, EdgePlane& plane) {
  return cutLayer(task, p, z, plane);
}
void numberLayerPortable(const GridShape& shape, std::uint64_t z, std::uint64_t number, EdgePlane& plane) {
  numberLayer(shape, z, number, plane);
}
TET4D_WIDE void numberLayerWide(const GridShape& shape, std::uint64_t z, std::uint64_t number, EdgePlane& plane) {
  numberLayer(shape, z, number, plane);
}

}  // namespace

SignPlane makeSignPlane(const GridShape& shape) {
  return {BitPlane(shape.words()), std::vector<RowState>(shape.rows(), RowState::kOutside)};
}

std::uint64_t signPlaneBytes(const GridShape& shape) {
  return shape.words() * sizeof(std::uint64_t) + shape.rows() * sizeof(RowState);
}

EdgeSet makeEdgeSet(const GridShape& shape, std::span<const EdgeDirection> directions, bool through_time) {
  EdgeSet set;
  for (const EdgeDirection& direction : directions) {
    if (((direction.axes & 8U) != 0) != through_time) continue;
    set.planes.push_back({direction.axes, std::vector<std::uint8_t>(shape.rows()), BitPlane(shape.words()),
                          std::vector<std::uint32_t>(shape.words())});
  }
  return set;
}

std::uint64_t edgeSetBytes(const GridShape& shape, std::size_t planes) {
  return std::uint64_t{planes} * (shape.words() * (sizeof(std::uint64_t) + sizeof(std::uint32_t)) + shape.rows());
}

void numberCutEdges(const GridShape& shape, const SignPlane& lower, const SignPlane& upper, const BitPlane& usable,
                    outofcore::Executor& executor, Simd simd, EdgeSet& set) {
  const std::uint64_t layers = shape.dims[2];
  std::vector<BitPlane> wanted;
  if (!usable.empty())
    for (const EdgePlane& plane : set.planes) wanted.push_back(edgesOfCells(shape, usable, plane.axes));

  std::vector<std::uint64_t> first(set.planes.size() * layers);  // counts, then numbers, of each plane's layers
  const CutTask task{shape, lower, upper, wanted};
  const auto cut = simd == Simd::kWide ? cutLayerWide : cutLayerPortable;
  executor.run(layers, [&](std::size_t z) {
    for (std::size_t p = 0; p < set.planes.size(); ++p) first[p * layers + z] = cut(task, p, z, set.planes[p]);
  });
  set.count = 0;
  for (std::uint64_t& number : first) set.count += std::exchange(number, set.count);
  if (set.count >> 32 != 0) {
    throw Error(FaultCode::kBadInput, "", "",
                std::to_string(set.count) + " vertices in one frame, local indices can name 2^32 - 1",
                "cut the grid into parts");
  }
  const auto number = simd == Simd::kWide ? numberLayerWide : numberLayerPortable;
  executor.run(layers, [&](std::size_t z) {
    for (std::size_t p = 0; p < set.planes.size(); ++p) number(shape, z, first[p * layers + z], set.planes[p]);
  });
}

BitPlane cellsWithoutNan(const GridShape& shape, const BitPlane& lower_nan, const BitPlane& upper_nan) {
  if (lower_nan.empty() && upper_nan.empty()) return {};
  BitPlane touched = lower_nan.empty() ? upper_nan : lower_nan;
  if (!lower_nan.empty() && !upper_nan.empty())
    for (std::size_t w = 0; w < touched.size(); ++w) touched[w] |= upper_nan[w];
  for (unsigned axis = kX; axis <= kZ; ++axis) spreadFromUpper(shape, axis, touched);
  for (std::uint64_t& word : touched) word = ~word;
  keepCells(shape, touched);
  return touched;
}

BitPlane usableInEither(const BitPlane& a, const BitPlane& b) {
  if (a.empty() || b.empty()) return {};
  BitPlane either = a;
  for (std::size_t w = 0; w < either.size(); ++w) either[w] |= b[w];
  return either;
}

std::uint64_t countBits(const BitPlane& plane) {
  std::uint64_t count = 0;
  for (const std::uint64_t word : plane) count += static_cast<std::uint64_t>(std::popcount(word));
  return count;
}

std::array<std::uint64_t, 3> firstBit(const GridShape& shape, const BitPlane& plane) {
  const auto word = static_cast<std::size_t>(
      std::find_if(plane.begin(), plane.end(), [](std::uint64_t w) { return w != 0; }) - plane.begin());
  const std::uint64_t row = word / shape.rowWords();
  return {word % shape.rowWords() * 64 + static_cast<std::uint64_t>(std::countr_zero(plane[word])), row % shape.dims[1],
          row / shape.dims[1]};
}

void shiftRow(std::span<const std::uint64_t> from, std::uint64_t shift, std::span<std::uint64_t> to) {
  const std::size_t words = shift / 64;
  const unsigned bits = static_cast<unsigned>(shift % 64);
  const auto source = [&](std::size_t w) { return w < from.size() ? from[w] : 0; };
  for (std::size_t w = 0; w < to.size(); ++w) {
    if (w < words) {
      to[w] = 0;
      continue;
    }
    to[w] = source(w - words) << bits;
    if (bits != 0 && w > words) to[w] |= source(w - words - 1) >> (64 - bits);
  }
}

}  // namespace tet4d::hypermesh
