// The two renderers behind one call. Given the same draw list they give the same picture within the tolerance of
// docs/numerics.md: OpenGL with the paper's lookup shader, and plain C++ with the slice formulas of formats/core.
#pragma once

#include <cstdint>
#include <memory>

#include "formats/core/result.h"
#include "player/render/image.h"
#include "player/scene/draw_list.h"
#include "player/stream/page_source.h"

namespace tet4d::render {

inline constexpr std::uint32_t kMaxSide = 16384;  // pixels, after multiplication by the samples' grid

class Renderer {
 public:
  virtual ~Renderer() = default;
  // "gl" or "cpu".
  virtual const char* name() const = 0;
  // Draws the list. Pages named by its items must be resident in `source`; a renderer serves one source only, because
  // it may keep copies of pages by their number. A Fault says what the machine or the driver refused.
  virtual Result<Image> draw(const scene::DrawList& list, const stream::PageSource& source) = 0;
};

// Side of the sample grid of a pixel (1, 2, 3 or 4), or a Fault (kUsage) if the format is not one the renderers serve.
Result<std::uint32_t> sampleGrid(const scene::Format& format);

// The Fault of a list that names a page which is not resident.
Fault absentPage(std::size_t page);

// The renderer in plain C++. threads: at least 1; the picture does not depend on it.
std::unique_ptr<Renderer> makeCpuRenderer(unsigned threads);

}  // namespace tet4d::render
