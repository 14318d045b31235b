// Columns of a hypermesh's vertices: normals, velocities, other fields sampled on the surface.
//
// Normals are unit, in world space, out of the inside; a velocity is the speed of the surface along its normal, in
// world units per world time: for the 4D normal N = (n, n_t) of the hypersurface it is -n_t / |n| along n / |n|. Where
// a surface appears at once everywhere the speed is infinite; it is kept below the domain's diagonal per frame. Both
// are zero where no normal can be told.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/hypermesh.h"
#include "libpreprocess/hypermesh/bit_planes.h"
#include "libpreprocess/hypermesh/sample_kernels.h"
#include "libpreprocess/outofcore/executor.h"

namespace tet4d::hypermesh {

// A 4D normal: x, y, z, t. Any length.
using Normal4 = std::array<double, 4>;

// Turns normals into columns.
class NormalMap {
 public:
  // `diagonal`: of the domain, world units.
  NormalMap(const AffineMap& map, double diagonal);
  // N in index space with t in world time units: a covector whose last entry belongs to one unit of time. `frame_time`:
  // world time between the frames around it, which bounds the speed.
  void columns(const Normal4& n, double frame_time, float* normal, float* velocity) const;

 private:
  std::array<std::array<double, 3>, 3> inverse_transposed_{};
  double diagonal_;
};

// Sums of the normals of the tetrahedra at each vertex of a slab (own, then next), each as long as 6 times the
// tetrahedron's 3-volume: the area-weighted normal.
class NormalSums {
 public:
  // Adds the tetrahedra of the slab; layers[z] .. layers[z + 1] are those of layer z, whose vertices layer z + 2 does
  // not share. frame_time: world time between the slab's frames. Same sums for any number of threads.
  void add(std::span<const Tet> tets, std::span<const std::uint64_t> layers, std::span<const Vec4f> own,
           std::span<const Vec4f> next, double frame_time, outofcore::Executor& executor);
  // Vertices no tetrahedron has touched have the sum 0.
  void extendTo(std::size_t vertices) { sums_.resize(std::max(sums_.size(), vertices), Normal4{}); }
  const Normal4& operator[](std::size_t vertex) const { return sums_[vertex]; }
  // Forgets the first `own` vertices; those of the next frame come first now.
  void advance(std::size_t own);

 private:
  std::vector<Normal4> sums_;
};

// A vertex's edge: its base on the lattice, its direction, and how far along it the vertex stands.
struct LatticeEdge {
  std::array<std::uint64_t, 3> base;
  std::size_t frame;
  std::uint8_t axes;
  double fraction;
};

// Calls visit(edge, i) for every edge of a set, i counting in the order of its numbers, on the executor's threads.
// positions: of the set's vertices. frame: of the edges' bases.
void forEachEdge(const GridShape& shape, const EdgeSet& set, std::size_t frame, std::span<const Vec4f> positions,
                 outofcore::Executor& executor, const std::function<void(const LatticeEdge&, std::size_t)>& visit);

// Frames to take values from.
struct FieldFrames {
  const SampleKernels& kernels;
  std::function<const std::byte*(std::size_t)> samples;  // of a frame
};

// The field at an edge's vertex, linear between the two samples; in the layers around the samples, the nearest one's.
double fieldAt(const GridShape& shape, const FieldFrames& field, const LatticeEdge& edge);

// The outward normal -grad f at an edge's vertex, linear between the gradients at both samples: central differences,
// one-sided at the grid's ends and beside values that are not finite. t by the frames' times, frames [0, count).
Normal4 gradientNormalAt(const GridShape& shape, const FieldFrames& field, std::span<const double> times,
                         std::size_t count, const LatticeEdge& edge);

}  // namespace tet4d::hypermesh
