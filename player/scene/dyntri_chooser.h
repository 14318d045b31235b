// Chooses what to draw of a file of dynamic triangles: pages by time and by view, then the run of triangles within
// each.
//
// Ponchio & Hormann 2008, sec. 7.1. A page's bands say, for each interval of its time, which run of their triangles can
// be alive then; a page without bands (files of version 1) is searched.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "player/scene/draw_list.h"
#include "player/stream/residency.h"

namespace tet4d::scene {

// True if one plane of the view has the whole box behind it. Conservative: a box near a corner of the view may stay.
bool isOutside(const Bounds4f& box, const DrawList& camera, const DrawSurface& surface);

// True if the page has triangles and its interval holds t.
bool isAlivePage(const paged::PageEntry& entry, float t, float last_t);

// The pages to bring in and draw at time t (frames): their interval holds t — half-open, closed at last_t — they have
// triangles, and their box is not outside the view. In page order. `surface`: the file's, of the list `camera`.
// O(pages).
std::vector<std::size_t> choosePages(std::span<const paged::PageEntry> entries, float t, float last_t,
                                     const DrawList& camera, const DrawSurface& surface);

// Fills in t, last_t, items and counts from those of `pages` that are resident: a run for each band, found in O(1). The
// exact count of living triangles reads the lifespans of the runs once, 8 bytes each, in vectors: a tenth of a
// millisecond for 200,000. A page without bands costs O(triangles that have begun).
void chooseTriangles(const stream::Residency& source, std::span<const std::size_t> pages, float t, float last_t,
                     DrawSurface& surface);

}  // namespace tet4d::scene
