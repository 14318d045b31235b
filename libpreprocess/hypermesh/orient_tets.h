// Tetrahedra of a mesh in space, all ordered one way.
//
// Where all volumes have one sign, every tetrahedron is ordered by it. Where they do not, or some are too small to
// tell, the order is carried over common triangles, so that neighbours always agree, and each connected part is ordered
// so that its volumes sum to the wanted sign: tetrahedra that lie folded over their neighbours stay inverted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "libpreprocess/outofcore/memory_budget.h"

namespace tet4d::hypermesh {

struct Orientation {
  std::uint64_t negative = 0;    // tetrahedra given with a negative volume
  std::uint64_t degenerate = 0;  // of a volume that rounding hides
  std::uint64_t inverted = 0;    // against their neighbours: the mesh is folded there
};

// Orders the tetrahedra so that their volumes det(b - a, c - a, d - a) are negative, the order of a hypermesh whose
// time is a scalar s with {s >= t} inside. Throws Error{kBadInput} naming `file`: a triangle of three tetrahedra, a
// mesh that cannot be oriented. O(tets), or O(tets log tets) and 69 bytes a tetrahedron of `memory` where signs differ.
Orientation orientTets(std::span<const std::array<double, 3>> points, std::span<std::array<std::uint32_t, 4>> tets,
                       const std::string& file, outofcore::MemoryBudget& memory);

}  // namespace tet4d::hypermesh
