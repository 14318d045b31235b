// Names what a page of a hypermesh needs of vertices that later pages own.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/hypermesh.h"

namespace tet4d::exchange {

// Turns a page's numbers at `owned` and above into local indices of runs, which it returns, their `first` counted from
// `first_vertex`, the page's own first number in the file. Gaps of a few vertices are bridged: a run costs as much as a
// vertex.
std::vector<hypermesh::Run> nameForeign(std::vector<hypermesh::Tet>& tets, std::uint64_t owned, std::uint64_t end,
                                        std::uint64_t first_vertex);

}  // namespace tet4d::exchange
