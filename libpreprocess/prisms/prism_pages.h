// The pages of a window: numbers of kept vertices, tetrahedra, runs of foreign vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/prisms/surface_edges.h"
#include "libpreprocess/prisms/window.h"

namespace tet4d::prisms {

// Numbers the kept vertices of a window: frame by frame, in each in the order of the input. By bit planes: a vertex's
// number is a prefix count plus a popcount.
class KeptNumbers {
 public:
  KeptNumbers(const Window& window, std::span<const Kept> kept);
  std::uint64_t begin(unsigned frame) const { return begin_[frame]; }  // of a frame's vertices; frame <= steps + 1
  std::uint64_t count(unsigned frame) const { return begin_[frame + 1] - begin_[frame]; }
  std::uint64_t numberOf(std::uint32_t vertex, unsigned frame) const;
  // The inverse. O(log vertices).
  struct Place {
    std::uint32_t vertex;
    unsigned frame;
  };
  Place placeOf(std::uint64_t number) const;
  // Appends a frame's kept vertices in order; t is the frame's number in the sequence.
  void appendVertices(const Window& window, unsigned frame, std::vector<Vec4f>& out) const;
  static std::uint64_t bytes(std::uint64_t vertices, unsigned steps) {
    return (vertices / 64 + 1) * 16 * (std::uint64_t{steps} + 1);
  }

 private:
  struct Plane {
    std::vector<std::uint64_t> bits, prefix;  // prefix: kept vertices in front of a word
  };
  std::vector<Plane> planes_;
  std::vector<std::uint64_t> begin_;
};

struct PrismPage {
  std::vector<hypermesh::Tet> tets;  // vertices: numbers of the window minus numbers.begin(frame)
  Bounds4f bounds;                   // of all vertices they use
};

// The tetrahedra whose earliest vertex is kept at `frame`, triangle by triangle. The same for any number of threads.
PrismPage prismPage(const Window& window, std::span<const Triangle> triangles, std::span<const Kept> kept,
                    const KeptNumbers& numbers, unsigned frame, outofcore::Executor& executor);

}  // namespace tet4d::prisms
