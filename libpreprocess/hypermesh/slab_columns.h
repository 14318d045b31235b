// The columns of a page, from what is in memory when its tetrahedra are made.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libpreprocess/hypermesh/frame_ring.h"
#include "libpreprocess/hypermesh/iso_part.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"
#include "libpreprocess/hypermesh/vertex_columns.h"

namespace tet4d::hypermesh {

// The second fields' frames: two at a time, read when a slab needs them.
class FieldReader {
 public:
  FieldReader(const Field& field, Simd simd);
  // Makes frames up to `frame` present, the two latest; `times`: of the frames known, at least two. Throws
  // Error{kBadInput} that names the field if it has no such frame, or has it at another time.
  void readTo(std::size_t frame, std::span<const double> times);
  // Throws Error{kBadInput} if the field has more frames than were read.
  void expectEnd();
  FieldFrames frames() const;
  std::uint64_t digest() const { return ring_.digest(); }

 private:
  const Field& field_;
  std::unique_ptr<SampleKernels> kernels_;
  FrameRing ring_;
};

// A slab's page in hand.
struct SlabPage {
  std::size_t slab;
  bool is_last;  // it also owns the next frame's vertices
  std::span<const Tet> tets;
  std::span<const std::uint64_t> layers;  // where each layer's tetrahedra begin, and their end
};

class SlabColumns {
 public:
  // main: the frames the surface is taken from; four of them for Normals::kGradient.
  SlabColumns(const GridShape& shape, const Options& options, const AffineMap& map, const FieldFrames& main,
              std::size_t parts);

  // The columns of part p's own vertices, in the order of columnsOf(). `times`: of the frames known. `fields`: at the
  // slab's frames. The spans last until the next call.
  std::span<const std::span<const float>> build(const IsoPart& part, std::size_t p, const SlabPage& page,
                                                std::span<const double> times, std::span<const FieldFrames> fields,
                                                outofcore::Executor& executor);
  // Bytes a page's columns need, with the sums of normals.
  std::uint64_t bytes(std::uint64_t own, std::uint64_t next) const;

 private:
  void forOwnEdges(const IsoPart& part, const SlabPage& page, outofcore::Executor& executor,
                   const std::function<void(const LatticeEdge&, std::size_t)>& visit) const;
  void addNormals(const IsoPart& part, std::size_t p, const SlabPage& page, std::span<const double> times,
                  outofcore::Executor& executor);

  const GridShape& shape_;
  const Options& options_;
  NormalMap map_;
  const FieldFrames& main_;
  std::vector<NormalSums> sums_;            // by part
  std::vector<std::vector<float>> values_;  // by column
  std::vector<std::span<const float>> spans_;
};

}  // namespace tet4d::hypermesh
