#include "libpreprocess/hypermesh/iso_part.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "libpreprocess/hypermesh/crossing.h"

namespace tet4d::hypermesh {

IsoPart::IsoPart(const GridShape& shape, const CellTable& table, const SampleKernels& kernels, std::size_t isovalue,
                 Simd simd)
    : shape_(shape), table_(table), kernels_(kernels), isovalue_(isovalue), simd_(simd) {
  for (SignPlane& plane : signs_) plane = makeSignPlane(shape);
  for (EdgeSet& set : within_) set = makeEdgeSet(shape, table.directions, false);
  for (EdgeSet& set : between_) set = makeEdgeSet(shape, table.directions, true);
}

std::uint64_t IsoPart::bytes(const GridShape& shape, const CellTable& table) {
  return 3 * signPlaneBytes(shape) + 2 * edgeSetBytes(shape, table.directions.size());
}

void IsoPart::numberWithin(std::size_t frame, const BitPlane& usable, outofcore::Executor& executor) {
  numberCutEdges(shape_, signs(frame), signs(frame), usable, executor, simd_, within_[frame % 2]);
}

void IsoPart::numberBetween(std::size_t slab, const BitPlane& usable, outofcore::Executor& executor) {
  numberCutEdges(shape_, signs(slab), signs(slab + 1), usable, executor, simd_, between_[slab % 2]);
}

void IsoPart::placeWithin(std::size_t frame, const std::byte* samples, outofcore::Executor& executor,
                          outofcore::MemoryBudget& memory) {
  next_.clear();
  place(within(frame), frame, samples, samples, next_, executor, memory);
}

void IsoPart::placeBetween(std::size_t slab, const std::byte* lower, const std::byte* upper,
                           outofcore::Executor& executor, outofcore::MemoryBudget& memory) {
  place(between(slab), slab, lower, upper, own_, executor, memory);
}

void IsoPart::joinNext(outofcore::MemoryBudget& memory) {
  position_memory_ = {};
  position_memory_ =
      memory.reserve((own_.capacity() + own_.size() + 2 * next_.size()) * sizeof(Vec4f), "vertices of the last frame");
  own_.reserve(own_.size() + next_.size());
  own_.insert(own_.end(), next_.begin(), next_.end());
  next_.clear();
}

void IsoPart::advance() {
  std::swap(own_, next_);
  next_.clear();
}

SlabTets IsoPart::slabTets(std::size_t slab, const BitPlane& usable) const {
  return {table_,
          Slab{shape_, signs_[slab % 3], signs_[(slab + 1) % 3], usable, within(slab), between(slab), within(slab + 1)},
          simd_};
}

void IsoPart::place(const EdgeSet& set, std::size_t frame, const std::byte* lower, const std::byte* upper,
                    std::vector<Vec4f>& out, outofcore::Executor& executor, outofcore::MemoryBudget& memory) {
  const std::size_t first = out.size();
  // While `out` grows, its old and its new place are held, beside the other set.
  position_memory_ = {};
  position_memory_ = memory.reserve((own_.capacity() + next_.capacity() + first + set.count) * sizeof(Vec4f),
                                    "vertices of frame " + std::to_string(frame));
  out.reserve(first + set.count);
  out.resize(first + set.count);
  executor.run(shape_.dims[2], [&](std::size_t z) {
    for (const EdgePlane& plane : set.planes) {
      for (std::uint64_t y = 0; y < shape_.dims[1]; ++y) {
        if (plane.used[shape_.row(y, z)] == 0) continue;
        Vec4f* const at = out.data() + first + plane.prefix[shape_.rowStart(y, z)];
        if (shape_.pad == 0) {
          placeRow(plane, y, z, frame, lower, upper, at);
        } else {
          placePaddedRow(plane, y, z, frame, lower, upper, at);
        }
      }
    }
  });
}

Vec4f* IsoPart::placeRow(const EdgePlane& plane, std::uint64_t y, std::uint64_t z, std::size_t frame,
                         const std::byte* lower, const std::byte* upper, Vec4f* out) const {
  const std::size_t base = shape_.sample(0, y, z);
  const std::size_t tip = base + (plane.axes & 1U) + (plane.axes >> 1 & 1U) * shape_.dims[0] +
                          (plane.axes >> 2 & 1U) * shape_.dims[0] * shape_.dims[1];
  const EdgeRowPlace row{
      std::span(plane.bits).subspan(shape_.rowStart(y, z), shape_.rowWords()), base, tip, plane.axes, y, z, frame};
  return kernels_.placeRow(row, lower, upper, isovalue_, out);
}

// Where one end may lie in the layers around the samples: it is outside, and the vertex stands next to the other end.
Vec4f* IsoPart::placePaddedRow(const EdgePlane& plane, std::uint64_t y, std::uint64_t z, std::size_t frame,
                               const std::byte* lower, const std::byte* upper, Vec4f* out) const {
  const auto isSample = [&](std::uint64_t x0, std::uint64_t y0, std::uint64_t z0) {
    return shape_.isSample(0, x0) && shape_.isSample(1, y0) && shape_.isSample(2, z0);
  };
  const auto pad = static_cast<std::int64_t>(shape_.pad);
  const unsigned dx = plane.axes & 1U, dy = plane.axes >> 1 & 1U, dz = plane.axes >> 2 & 1U;
  for (std::size_t w = 0; w < shape_.rowWords(); ++w) {
    for (std::uint64_t rest = plane.bits[shape_.rowStart(y, z) + w]; rest != 0; rest &= rest - 1) {
      const std::uint64_t x = w * 64 + static_cast<std::uint64_t>(std::countr_zero(rest));
      double fraction = 0;
      if (!isSample(x, y, z)) {
        fraction = 1 - kCrossingMargin;
      } else if (!isSample(x + dx, y + dy, z + dz)) {
        fraction = kCrossingMargin;
      } else {
        fraction = crossingFraction(kernels_.value(lower, shape_.sample(x, y, z)),
                                    kernels_.value(upper, shape_.sample(x + dx, y + dy, z + dz)),
                                    kernels_.isovalue(isovalue_));
      }
      const auto along = [&](unsigned axis, std::int64_t index) {
        return (plane.axes >> axis & 1U) != 0 ? strictlyBetween(index, fraction) : static_cast<float>(index);
      };
      *out++ = {along(0, static_cast<std::int64_t>(x) - pad), along(1, static_cast<std::int64_t>(y) - pad),
                along(2, static_cast<std::int64_t>(z) - pad), along(3, static_cast<std::int64_t>(frame))};
    }
  }
  return out;
}

}  // namespace tet4d::hypermesh
