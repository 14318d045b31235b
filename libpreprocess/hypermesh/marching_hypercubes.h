// Marching hypercubes: frames of a scalar grid to a hypermesh, frames streamed in time order. Ponchio & Hormann 2008,
// sec. 3 and 4; table: Bhaniramka, Wenger & Crawfis 2000/2004.
//
// A sample is inside if it is >= the isovalue. Every edge of the space-time grid whose ends differ carries one vertex
// (crossing.h). Let F_k be the vertices inside frame k and E_k those from frame k to k + 1, each numbered direction by
// direction, then z, y, x. Global order: F_0 E_0 F_1 E_1 … Page k is the slab between frames k and k + 1; it owns F_k
// and E_k and refers to F_{k+1} as its one run of foreign vertices, except that the last page owns that set too. A slab
// without surface is an empty page. Tetrahedra come by cell: z, y, x.
//
// With several isovalues each is a part: slab k has a page for each, in the order of the isovalues, whose run of
// foreign vertices lies in the part's next page; behind the last slab stands a page a part, without tetrahedra, that
// owns the last frame's vertices. Such pages give their slab as time bounds.
//
// `pad` layers of outside around every frame close the surface at the walls: vertices between a sample and the outside
// stand next to the sample.
//
// Two frames of samples are held, in the source's own type (four for normals from gradients); the bytes written do not
// depend on the executor's threads, nor on whether the source is a stream.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/hypermesh/page_sink.h"
#include "libpreprocess/hypermesh/simd.h"
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

// Where the column "normal" comes from.
enum class Normals {
  kNone,      // no such column
  kTets,      // sums of the tetrahedra's normals, weighted by their 3-volumes
  kGradient,  // the field's gradient; four frames are held instead of two
};

// A second field, sampled on the surface as a column of one component. Its frames lie on the source's grid.
struct Field {
  std::string name;
  exchange::FrameSource* frames = nullptr;
};

struct Options {
  double iso = 0;
  std::vector<double> more_isos = {};  // of further parts
  Split split = Split::kHull;
  NanRule nan = NanRule::kOutside;
  std::uint64_t pad = 0;  // layers of outside around the samples
  Normals normals = Normals::kNone;
  bool velocity = false;  // the column "velocity", from the same normals (from tetrahedra if normals are kNone)
  std::vector<Field> fields = {};
  paged::Codec page_codec = paged::Codec::kRaw;
  Simd simd = bestSimd();

  std::vector<double> isovalues() const;
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
  std::uint64_t samples_xxh3 = 0;          // over the frames' XXH3s, each over its samples as stored, little-endian
  std::vector<std::uint64_t> fields_xxh3;  // the same of each field
  struct Part {
    double isovalue = 0;
    std::uint64_t vertices = 0, tets = 0;
  };
  std::vector<Part> parts;  // one an isovalue
};

// What a run will need, from the grid alone.
struct Plan {
  std::uint64_t passes = 1;
  std::uint64_t fixed_bytes = 0;         // frames, bit planes, vertex numbers, of all parts
  std::uint64_t most_page_bytes = 0;     // beside them, if every cell of a slab had the worst configuration
  std::uint64_t least_output_bytes = 0;  // no surface at all
  std::uint64_t most_output_bytes = 0;   // every cell the worst, uncompressed
};

// Checks that a hypermesh can be made: at least two frames (of a stream one: the run waits for its second) and two
// samples along every axis, none above 2^22 (positions are f32), finite and different isovalues, fields on the same
// grid. Throws Error{kBadInput, kUsage}.
void checkSource(exchange::FrameSource& source, const Options& options);

// The header of the file to be written: kOnGrid, the source's map, the domain [0, dims - 1] x [0, frames - 1], wider by
// the padding. Of a stream, the frames known so far.
MeshHeader meshHeader(exchange::FrameSource& source, const Options& options);

// The columns of the file, in order: normal (3), velocity (3), the fields.
std::vector<Writer::Column> columnsOf(const Options& options);

// The file for a run: header, times, columns and parts.
Writer createWriter(const std::string& path, exchange::FrameSource& source, const Options& options, bool force);

// Of a stream, for the frames known so far.
Plan plan(exchange::FrameSource& source, const Options& options);

// Reads every frame once, in order, and gives the pages to `sink`. Phases: read, extract, write, in turn for every
// frame. Throws Error: checkSource's, the source's, the sink's, kOutOfMemory if the budget does not hold
// plan().fixed_bytes plus the page in hand (compressed pages are held twice more), kBadInput if a slab has 2^32
// vertices or more.
Stats buildHypermesh(exchange::FrameSource& source, PageSink& sink, const Options& options,
                     outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress);

// The same into a file made by createWriter(); the caller closes it.
Stats buildHypermesh(exchange::FrameSource& source, Writer& writer, const Options& options,
                     outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress);

}  // namespace tet4d::hypermesh
