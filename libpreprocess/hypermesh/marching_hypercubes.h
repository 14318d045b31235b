// Marching hypercubes: frames of a scalar grid to a hypermesh, frames streamed in time order. Ponchio & Hormann 2008,
// sec. 3 and 4; table: Bhaniramka, Wenger & Crawfis 2000/2004.
//
// A sample is inside if it is >= the isovalue. Every edge of the space-time grid whose ends differ carries one vertex
// (crossing.h). Let F_k be the vertices inside frame k and E_k those from frame k to k + 1, each numbered direction by
// direction, then z, y, x. Global order: F_0 E_0 F_1 E_1 … Page k is the slab between frames k and k + 1; it owns F_k
// and E_k and refers to F_{k+1} as its one run of foreign vertices, except that the last page owns that set too. A slab
// without surface is an empty page. Tetrahedra come by cell: z, y, x.
//
// Two frames of samples are held, never more; the bytes written do not depend on the executor's threads.
#pragma once

#include <cstdint>
#include <limits>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::hypermesh {

enum class Split {
  kHull,  // the convex-hull table
  kKuhn,  // 24 pentatopes a cell: the oracle, 5 times the tetrahedra
};

enum class NanRule {
  kOutside,  // a NaN is outside; vertices stand next to the inside sample
  kMask,     // cells that touch a NaN are left out: boundary inside the box, kInnerBoundary in the file
  kError,    // Error{kBadInput} names the first one
};

struct Options {
  double iso = 0;
  Split split = Split::kHull;
  NanRule nan = NanRule::kOutside;
  paged::Codec page_codec = paged::Codec::kRaw;
};

struct Stats {
  std::uint64_t vertices = 0, tets = 0;
  std::uint64_t active_cells = 0;  // hypercubes whose sixteen corners are not all alike
  std::uint64_t masked_cells = 0;  // hypercubes left out because they touch a NaN (NanRule::kMask)
  std::uint64_t frames = 0;
  std::uint64_t voxels = 0;  // samples of all frames
  std::uint64_t nan_samples = 0;
  double min_value = std::numeric_limits<double>::infinity();  // of samples that are no NaN; min > max: there is none
  double max_value = -std::numeric_limits<double>::infinity();
  std::uint64_t samples_xxh3 = 0;  // over the frames' XXH3s, each over its samples as stored, little-endian
};

// What a run will need, from the grid alone.
struct Plan {
  std::uint64_t passes = 1;
  std::uint64_t fixed_bytes = 0;         // frames, bit planes, vertex numbers
  std::uint64_t most_page_bytes = 0;     // beside them, if every cell of a slab had the worst configuration
  std::uint64_t least_output_bytes = 0;  // no surface at all
  std::uint64_t most_output_bytes = 0;   // every cell the worst, uncompressed
};

// Checks that a hypermesh can be made: at least two frames and two samples along every axis, none above 2^22 (positions
// are f32), a finite isovalue. Throws Error{kBadInput, kUsage}.
void checkSource(const exchange::FrameSource& source, const Options& options);

// The header of the file to be written: kOnGrid, the source's map, the domain [0, dims - 1] x [0, frames - 1].
MeshHeader meshHeader(const exchange::FrameSource& source, const Options& options);

Plan plan(const exchange::FrameSource& source, const Options& options);

// Reads every frame once, in order, and adds one page a slab to `writer` (made with meshHeader(); the caller closes
// it). Phases: read, extract, write, in turn for every frame. Throws Error: checkSource's, the source's, the writer's,
// kOutOfMemory if the budget does not hold plan().fixed_bytes plus twice the page in hand, kBadInput if a slab has 2^32
// vertices or more.
Stats buildHypermesh(exchange::FrameSource& source, Writer& writer, const Options& options,
                     outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress);

}  // namespace tet4d::hypermesh
