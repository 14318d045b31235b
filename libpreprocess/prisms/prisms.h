// A compatible mesh sequence to a hypermesh: each triangle over time is a column of tetrahedra in space-time, frames
// streamed. Ponchio & Hormann 2008, sec. 4.2.
//
// Page k holds the vertices kept at frame k and the tetrahedra whose earliest vertex is one of them, so pages are time
// slabs in order of their beginnings; where motion is straight a slab's tetrahedra reach over several frames, at most
// to the end of the window. Vertices: frame by frame, in each in the input's order; the last page owns the last frame
// too. Held at once: a window's frames (two of --linear-window 1) and one page. The bytes do not depend on threads.
#pragma once

#include <cstdint>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/surface_source.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::prisms {

struct Options {
  // How far a slice at an input's frame may be from the input: world units, or with `relative` a part of the diagonal
  // of the first frame's box. To it comes one f32 step of the window's largest coordinate: 0 leaves out what f32 cannot
  // tell from straight motion.
  double linear_tolerance = 0;
  bool relative = false;
  std::uint64_t linear_window = 16;  // most steps in which motion is looked at as one; 1 keeps every frame
  paged::Codec page_codec = paged::Codec::kRaw;
};

struct Stats {
  std::uint64_t vertices = 0, tets = 0;  // of the hypermesh
  std::uint64_t frames = 0, triangles = 0;
  std::uint64_t tets_expanded = 0;    // there would be with every frame kept: 3 * triangles * (frames - 1)
  std::uint64_t unused_vertices = 0;  // of the input, in no triangle
  std::uint64_t open_edges = 0, edges_over_two = 0, misoriented_edges = 0;
  double tolerance = 0;          // world units, as asked for
  double error_measured = 0;     // world units: the largest distance of a slice at a frame from the input
  std::uint64_t input_xxh3 = 0;  // over triangles, map and positions, whatever files they came from
};

// What a run will need, from the counts alone.
struct Plan {
  std::uint64_t passes = 1;
  std::uint64_t fixed_bytes = 0;                                // a window's frames, what is kept of them, edges
  std::uint64_t most_page_bytes = 0;                            // beside them
  std::uint64_t least_output_bytes = 0, most_output_bytes = 0;  // uncompressed
};

// Checks that a hypermesh can be made: two frames and a triangle at least, a tolerance that is a number and not below
// 0, a window of 1 to 63 steps. Throws Error{kBadInput, kUsage}.
void checkSource(const exchange::SurfaceSource& source, const Options& options);

// The header of the file to be written; the domain's box follows at the end of the run.
hypermesh::MeshHeader meshHeader(const exchange::SurfaceSource& source);

Plan plan(const exchange::SurfaceSource& source, const Options& options);

// Reads every frame once, in order, and adds one page a step to `writer` (made with meshHeader(); the caller closes
// it). Page entries tell the errors, world units. Phases: read, fit, extract, measure, write, in turn for every window.
// Throws Error: checkSource's, the source's, the writer's, kOutOfMemory.
Stats buildPrisms(exchange::SurfaceSource& source, hypermesh::Writer& writer, const Options& options,
                  outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress);

}  // namespace tet4d::prisms
