// A mesh cut into blocks of vertices, near ones together: what a sweep of simplifyBlocks() works on. Private to
// qslim4d.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/qslim4d/slim_mesh.h"

namespace tet4d::qslim4d {

struct VertexBlocks {
  std::vector<std::uint32_t> order;       // used vertices, block after block, ascending in each
  std::vector<std::uint32_t> begins;      // of each block in `order`, and the end
  std::vector<std::uint32_t> places;      // by vertex: its place in `order`; kNone: unused
  std::vector<std::uint8_t> is_shared;    // by place: a tetrahedron there has a vertex of another block
  std::vector<std::uint32_t> tets;        // with a vertex that is not shared: block after block, ascending in each
  std::vector<std::uint32_t> tet_begins;  // of each block in `tets`, and the end

  std::size_t count() const { return begins.size() - 1; }
  std::span<const std::uint32_t> verticesOf(std::size_t block) const {
    return std::span(order).subspan(begins[block], begins[block + 1] - begins[block]);
  }
  std::span<const std::uint32_t> tetsOf(std::size_t block) const {
    return std::span(tets).subspan(tet_begins[block], tet_begins[block + 1] - tet_begins[block]);
  }
};

// Blocks of about `block_vertices` vertices (64 at least; 256 more at most), by a k-d tree over space and time, time
// measured by the mesh's speed. Other sweeps cut at other places. Needs no stars but which of them are empty. The same
// for any number of threads. O(vertices log blocks + tets).
VertexBlocks cutBlocks(const SlimMesh& mesh, std::size_t block_vertices, std::size_t sweep,
                       outofcore::Executor& executor);

// Bytes of blocks of so many vertices and tetrahedra, with what cutting them takes.
std::uint64_t blockListBytes(std::uint64_t vertices, std::uint64_t tets);

}  // namespace tet4d::qslim4d
