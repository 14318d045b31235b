// A hypermesh page by page, its pages' vertices being the mesh's vertices in order.
#pragma once

#include <cstdint>
#include <functional>

#include "formats/hypermesh.h"

namespace tet4d::exchange {

// Calls `visit` for every geometry page in order. Throws Error{kBadInput} if the pages' own vertices are not the
// numbers 0, 1, 2 … in order, or the counts are not those of the header. Memory of one page and its neighbours.
void forEachPage(const hypermesh::File& mesh, const std::function<void(const hypermesh::GatheredPage&)>& visit);

// As forEachPage, the pages' own vertices only.
void forEachVertex(const hypermesh::File& mesh, const std::function<void(const Vec4f&)>& visit);

// Global numbers of a page's local indices: ids[local]. O(own and foreign vertices).
std::vector<std::uint64_t> globalNumbers(const hypermesh::PageView& page);

}  // namespace tet4d::exchange
