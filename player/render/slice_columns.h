// Columns of a file on the vertices of a page's slice: interpolated along the edge exactly as the positions are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "player/scene/draw_column.h"

namespace tet4d::render {

// One number for each of `keys` (PageSlice::keys) at t: a component or the length of the interpolated row. `rows`: of
// the page's vertices; empty: all unknown (NaN).
std::vector<float> sliceValues(const dyntri::PageView& page, std::span<const std::uint32_t> keys, float t,
                               const scene::DrawColumn& column, std::span<const float> rows);

// Three numbers for each key, from a column of three.
std::vector<Vec3f> sliceVectors(const dyntri::PageView& page, std::span<const std::uint32_t> keys, float t,
                                std::span<const float> rows);

}  // namespace tet4d::render
