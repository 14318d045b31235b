#include "libpreprocess/hypermesh/bit_planes.h"

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

// The cut edges of one z layer; returns how many.
std::uint64_t cutLayer(const GridShape& shape, const BitPlane& lower, const BitPlane& upper, std::uint64_t z,
                       EdgePlane& plane) {
  const unsigned dx = plane.axes & 1U, dy = plane.axes >> 1 & 1U, dz = plane.axes >> 2 & 1U;
  const std::size_t row = shape.rowWords();
  std::uint64_t count = 0;
  for (std::uint64_t y = 0; y < shape.dims[1]; ++y) {
    std::uint64_t* out = &plane.bits[shape.rowStart(y, z)];
    if (y + dy >= shape.dims[1] || z + dz >= shape.dims[2]) {
      std::fill(out, out + row, 0);
      continue;
    }
    const std::uint64_t* a = &lower[shape.rowStart(y, z)];
    const std::uint64_t* b = &upper[shape.rowStart(y + dy, z + dz)];
    for (std::size_t w = 0; w < row; ++w) {
      const std::uint64_t next = w + 1 < row ? b[w + 1] : 0;
      const std::uint64_t tip = dx ? b[w] >> 1 | next << 63 : b[w];
      out[w] = (a[w] ^ tip) & GridShape::bitsBelow(shape.dims[0] - dx, w);
      count += static_cast<std::uint64_t>(std::popcount(out[w]));
    }
  }
  return count;
}

}  // namespace

EdgeSet makeEdgeSet(const GridShape& shape, std::span<const EdgeDirection> directions, bool through_time) {
  EdgeSet set;
  for (const EdgeDirection& direction : directions) {
    if (((direction.axes & 8U) != 0) != through_time) continue;
    set.planes.push_back({direction.axes, BitPlane(shape.words()), std::vector<std::uint32_t>(shape.words())});
  }
  return set;
}

std::uint64_t edgeSetBytes(const GridShape& shape, std::size_t planes) {
  return std::uint64_t{planes} * shape.words() * (sizeof(std::uint64_t) + sizeof(std::uint32_t));
}

void numberCutEdges(const GridShape& shape, const BitPlane& lower, const BitPlane& upper, const BitPlane& usable,
                    outofcore::Executor& executor, EdgeSet& set) {
  const std::uint64_t layers = shape.dims[2];
  const std::size_t layer_words = shape.rowWords() * shape.dims[1];
  std::vector<BitPlane> wanted;
  if (!usable.empty())
    for (const EdgePlane& plane : set.planes) wanted.push_back(edgesOfCells(shape, usable, plane.axes));

  std::vector<std::uint64_t> first(set.planes.size() * layers);  // counts, then numbers, of each plane's layers
  executor.run(layers, [&](std::size_t z) {
    for (std::size_t p = 0; p < set.planes.size(); ++p) {
      std::uint64_t count = cutLayer(shape, lower, upper, z, set.planes[p]);
      if (!wanted.empty()) {
        count = 0;
        for (std::size_t w = z * layer_words; w < (z + 1) * layer_words; ++w)
          count += static_cast<std::uint64_t>(std::popcount(set.planes[p].bits[w] &= wanted[p][w]));
      }
      first[p * layers + z] = count;
    }
  });
  set.count = 0;
  for (std::uint64_t& number : first) set.count += std::exchange(number, set.count);
  if (set.count >> 32 != 0) {
    throw Error(FaultCode::kBadInput, "", "",
                std::to_string(set.count) + " vertices in one frame, local indices can name 2^32 - 1",
                "cut the grid into parts");
  }
  executor.run(layers, [&](std::size_t z) {
    for (std::size_t p = 0; p < set.planes.size(); ++p) {
      EdgePlane& plane = set.planes[p];
      std::uint64_t number = first[p * layers + z];
      for (std::size_t w = z * layer_words; w < (z + 1) * layer_words; ++w) {
        plane.prefix[w] = static_cast<std::uint32_t>(number);
        number += static_cast<std::uint64_t>(std::popcount(plane.bits[w]));
      }
    }
  });
}

BitPlane cellsWithoutNan(const GridShape& shape, const FrameBits& lower, const FrameBits& upper) {
  if (lower.nan.empty() && upper.nan.empty()) return {};
  BitPlane touched = lower.nan.empty() ? upper.nan : lower.nan;
  if (!lower.nan.empty() && !upper.nan.empty())
    for (std::size_t w = 0; w < touched.size(); ++w) touched[w] |= upper.nan[w];
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

}  // namespace tet4d::hypermesh
