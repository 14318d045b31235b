#include "player/host/memory_plan.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "player/host/png.h"
#include "player/stream/page_buffer.h"

namespace tet4d::host {
namespace {

// A sample: CPU: colour 4, depth 4 and id 4 of the surface, the same of the walls. GL: colour 4 of this picture and
// of the next, depth 4, read back 4, and the walls once more where a surface refracts.
constexpr std::uint64_t kCpuSampleBytes = 24, kGlSampleBytes = 20;
// A pixel: the averaged picture.
constexpr std::uint64_t kPictureBytes = 4;
// A texel of summed normals in the driver, in front of it, and its slice vertex's number; how many a row has.
constexpr std::uint64_t kTexelBytes = 36, kRowTexels = 4096;

std::uint64_t heldBytes(const paged::PageEntry& entry) {
  const bool is_raw = entry.codec == static_cast<std::uint32_t>(paged::Codec::kRaw);
  return stream::PageBuffer::cost(entry.raw_bytes) + (is_raw ? 0 : stream::PageBuffer::cost(entry.bytes));
}

}  // namespace

std::uint64_t usualPageBytes() {
  const auto pages = static_cast<std::uint64_t>(std::max(sysconf(_SC_PHYS_PAGES), 0L));
  const auto page_bytes = static_cast<std::uint64_t>(std::max(sysconf(_SC_PAGESIZE), 0L));
  const std::uint64_t usual = pages * page_bytes / 4;
  rlimit limit{};
  const bool is_limited = getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return is_limited ? std::min<std::uint64_t>(usual, limit.rlim_cur / 2) : usual;
}

MemoryPlan planMemory(const Film& film, const ContactSheet* sheet, bool is_gl) {
  MemoryPlan plan;
  plan.copies = is_gl ? 2 : 1;
  const std::uint64_t pixels = std::uint64_t{film.format.width} * film.format.height;
  plan.pictures = pixels * film.format.samples * (is_gl ? kGlSampleBytes : kCpuSampleBytes) +
                  pixels * (kPictureBytes + kEncodingBytes);
  if (sheet != nullptr) plan.sheet = sheet->bytes(film.format.width, film.format.height);
  for (std::size_t i = 0; i < film.times.size(); ++i) {
    const scene::DrawList list = scene::makeDrawList(film.files, shotOfFrame(film, i), film.format, film.smooth);
    std::uint64_t bytes = 0;
    for (const scene::DrawSurface& surface : list.surfaces) {
      const std::optional<float> t = film.times[i].frames[surface.source];
      if (!film.files[surface.source].shown || !t) continue;
      const dyntri::File& file = *film.files[surface.source].file;
      const auto entries = file.geometryEntries();
      for (const std::size_t page : scene::choosePages(entries, *t, file.header().last_time, list, surface)) {
        bytes += plan.copies * heldBytes(entries[page]);
        const std::size_t first = page * (1 + file.columns().size());
        for (const std::size_t column : scene::columnsOf(film.files[surface.source]))
          bytes += plan.copies * heldBytes(file.pages().entries()[first + 1 + column]);
        const std::uint64_t rows = (entries[page].counts[0] + entries[page].counts[1] + kRowTexels - 1) / kRowTexels;
        if (is_gl && film.smooth) plan.normals = std::max(plan.normals, rows * kRowTexels * kTexelBytes);
      }
    }
    plan.frame_pages = std::max(plan.frame_pages, bytes);
  }
  return plan;
}

}  // namespace tet4d::host
