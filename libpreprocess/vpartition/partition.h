// A partition of space-time into cells, one of the sequence H1 .. Hn. Ponchio & Hormann 2008, sec. 6.3.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libpreprocess/vpartition/lattice.h"

namespace tet4d::vpartition {

// A tetrahedron that stands for others where a partition is made.
struct Sample {
  Place at;           // of the tetrahedron, see Place
  double weight = 1;  // tetrahedra it stands for
  double space2 = 0;  // sum of its edges' squared lengths in space, steps
  double time2 = 0;   // the same along time
};

class Partition {
 public:
  virtual ~Partition() = default;
  virtual std::uint32_t cells() const = 0;
  // The cell of a tetrahedron by its place. Exact; thread-safe.
  virtual std::uint32_t ownerOf(const Place& at) const = 0;
};

enum class Kind { kVoronoi, kKd };

// Makes a partition of about `cells` cells of the same weight; at least one, at most as many as there are samples.
// level and seed: partitions that differ in either have their borders elsewhere. O(samples log cells) a relaxation.
std::unique_ptr<const Partition> makePartition(Kind kind, std::span<const Sample> samples, std::uint32_t cells,
                                               std::uint32_t level, std::uint64_t seed);

// Draws samples from tetrahedra that come in order of time: a reservoir for each slab of frames, so that every time is
// stood for, whatever little happens then. Vitter 1985.
class Sampler {
 public:
  // most: samples in all, shared by the slabs. frames: t of what comes lies in 0 .. frames.
  Sampler(std::size_t most, double frames, std::uint64_t seed);
  void add(const Sample& sample, double t);
  // Weights are set. The sampler is empty then.
  std::vector<Sample> take();

 private:
  struct Slab {
    std::vector<Sample> kept;
    std::uint64_t seen = 0, random = 0;
  };
  std::size_t quota_;
  double per_frame_;
  std::vector<Slab> slabs_;
};

}  // namespace tet4d::vpartition
