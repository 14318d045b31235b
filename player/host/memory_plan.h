// What a film will hold in memory, known from the page table before anything is drawn.
#pragma once

#include <cstdint>

#include "player/host/playback.h"

namespace tet4d::host {

// Bytes. Libraries and the driver's own needs are not in it; pages are counted decoded, compressed ones with what is
// read.
struct MemoryPlan {
  std::uint64_t pictures = 0;     // framebuffers of all samples, the picture, its encoding
  std::uint64_t normals = 0;      // gl, smooth: the texture that gathers normals, for the largest page
  std::uint64_t sheet = 0;        // tiles, the composed sheet, its encoding
  std::uint64_t frame_pages = 0;  // the most that the pages of one frame take, with the driver's copies
  unsigned copies = 1;            // of a page: 2 for gl
};

// `sheet` may be null. `film` as play() takes it, its format proved by render::sampleGrid(). O(pictures * pages).
MemoryPlan planMemory(const Film& film, const ContactSheet* sheet, bool is_gl);

// What to keep of pages when nobody says: a quarter of the machine's memory, no more than half of what the process may
// have (prlimit --data).
std::uint64_t usualPageBytes();

}  // namespace tet4d::host
