// The cheap edges of a large mesh, block by block, before the rounds of `passes`. Private to qslim4d.
#pragma once

#include "libpreprocess/qslim4d/orders.h"

namespace tet4d::qslim4d {

// Sweeps over blocks of vertices (vertex_blocks.h) until little is left to do: each cuts the mesh elsewhere, and in
// each block edges up to a cost are collapsed, the cheapest first; the cost rises from sweep to sweep. Leaves alone a
// mesh of few blocks. The same for any number of threads.
void sweepBlocks(SlimMesh& mesh, const Options& options, outofcore::Executor& executor, Ledger& ledger);

// Bytes that it takes at most beside a mesh without corners.
std::uint64_t sweepBytes(std::uint64_t vertices, std::uint64_t tets, std::size_t block_vertices);

}  // namespace tet4d::qslim4d
