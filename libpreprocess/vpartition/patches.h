// Pieces of a cell that are small enough to be drawn, read and dropped as one. Private to vpartition.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/patch_dag.h"
#include "libpreprocess/vpartition/lattice.h"

namespace tet4d::vpartition {

// Most tetrahedra of a patch: four corners each stay below patch_dag::kMostVertices.
inline constexpr std::uint64_t kMostPatchTets = patch_dag::kMostVertices / 4;

// A patch as it waits for being written. Nodes by the number the builder gave them.
struct StoredPatch {
  std::uint32_t upper = 0, lower = 0;
  std::uint32_t shared = 0;
  std::vector<Vec4f> vertices;
  std::vector<patch_dag::LocalTet> tets;
};

// Tetrahedra of one patch: order[begin] … order[end - 1].
struct PatchRange {
  std::uint32_t begin, end;
  std::uint32_t lower;
};

// Cuts the tetrahedra `order` of a cell by the node they were left by, and those of each in halves across their longest
// extent until none has more than `most`. Reorders them. O(n log n).
std::vector<PatchRange> cutPatches(std::span<std::uint32_t> order, std::span<const std::uint32_t> left_by,
                                   std::span<const Place> places, std::uint64_t most);

// The only user of a vertex, or:
inline constexpr std::uint32_t kUnused = 0xffffffffu, kSeveral = kUnused - 1;

// Notes in `users`, by vertex, that `user` uses it.
inline void noteUser(std::span<std::uint32_t> users, const hypermesh::Tet& tet, std::uint32_t user) {
  for (const std::uint32_t v : tet) {
    std::uint32_t& known = users[v];
    known = known == kUnused || known == user ? user : kSeveral;
  }
}

// The patch of some tetrahedra. users: by vertex, the patches of its level; vertices of several stand in front.
StoredPatch makePatch(std::span<const std::uint32_t> chosen, std::span<const hypermesh::Tet> tets,
                      std::span<const Vec4f> positions, std::span<const std::uint32_t> users);

}  // namespace tet4d::vpartition
