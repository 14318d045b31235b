// What a film will hold in memory, known from the page table before anything is drawn.
#pragma once

#include <cstdint>

#include "player/host/playback.h"

namespace tet4d::host {

// Bytes. Libraries and the driver's own needs are not in it; mapped input is counted as if it were decoded.
struct MemoryPlan {
  std::uint64_t pictures = 0;     // framebuffers of all samples, the picture, its encoding
  std::uint64_t normals = 0;      // gl, smooth: the texture that gathers normals, for the largest page
  std::uint64_t sheet = 0;        // tiles, the composed sheet, its encoding
  std::uint64_t frame_pages = 0;  // the most that the pages of one frame take, with the driver's copies
  unsigned copies = 1;            // of a page: 2 for gl
};

// `sheet` may be null. `film` as play() takes it, its format proved by render::sampleGrid(). O(pictures * pages).
MemoryPlan planMemory(const Film& film, const ContactSheet* sheet, bool is_gl);

}  // namespace tet4d::host
