#include "player/host/memory_plan.h"

#include <algorithm>

#include "player/host/png.h"

namespace tet4d::host {
namespace {

// A sample: CPU: colour 4, depth 4 and id 4 of the surface, the same of the walls. GL: colour 4, depth 4, read back 4.
constexpr std::uint64_t kCpuSampleBytes = 20, kGlSampleBytes = 12;
// A pixel: the averaged picture.
constexpr std::uint64_t kPictureBytes = 4;
// A texel of summed normals, and how many a row has.
constexpr std::uint64_t kTexelBytes = 16, kRowTexels = 4096;

}  // namespace

MemoryPlan planMemory(const dyntri::File& file, const Film& film, const ContactSheet* sheet, bool is_gl) {
  MemoryPlan plan;
  plan.copies = is_gl ? 2 : 1;
  const std::uint64_t pixels = std::uint64_t{film.format.width} * film.format.height;
  plan.pictures = pixels * film.format.samples * (is_gl ? kGlSampleBytes : kCpuSampleBytes) +
                  pixels * (kPictureBytes + kEncodingBytes);
  if (sheet != nullptr) plan.sheet = sheet->bytes(film.format.width, film.format.height);
  const scene::WorldBox box = scene::worldBox(file.header().index_to_world, file.header().bounds);
  const float last_t = file.header().last_time;
  for (std::size_t i = 0; i < film.frame_numbers.size(); ++i) {
    const scene::DrawList camera = scene::makeDrawList(box, shotOfFrame(film, i), film.format, film.smooth);
    std::uint64_t bytes = 0;
    for (const std::size_t page : scene::choosePages(file.pages().entries(), film.frame_numbers[i], last_t, camera)) {
      const paged::PageEntry& entry = file.pages().entries()[page];
      bytes += plan.copies * entry.raw_bytes;
      const std::uint64_t rows = (entry.counts[0] + entry.counts[1] + kRowTexels - 1) / kRowTexels;
      if (is_gl && film.smooth) plan.normals = std::max(plan.normals, rows * kRowTexels * kTexelBytes);
    }
    plan.frame_pages = std::max(plan.frame_pages, bytes);
  }
  return plan;
}

}  // namespace tet4d::host
