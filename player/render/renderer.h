// The two renderers behind one call. Given the same draw list they give the same picture within the tolerance of
// docs/numerics.md: OpenGL with the paper's lookup shader, and plain C++ with the slice formulas of formats/core.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/result.h"
#include "player/render/image.h"
#include "player/scene/draw_list.h"
#include "player/stream/residency.h"

namespace tet4d::render {

inline constexpr std::uint32_t kMaxSide = 16384;  // pixels, after multiplication by the samples' grid

class Renderer {
 public:
  virtual ~Renderer() = default;
  // "gl", "cpu" or "tets".
  virtual const char* name() const = 0;
  // Of copies of pages that are kept in the driver's memory now.
  virtual std::uint64_t gpuBytes() const { return 0; }
  // Draws the list. Pages named by a surface's items must be resident in sources[surface.source]. A renderer may keep
  // copies of pages by source and number: the same rank must mean the same file in every call. A Fault says what the
  // machine or the driver refused.
  virtual Result<Image> draw(const scene::DrawList& list, std::span<const stream::Residency* const> sources) = 0;
  // Draws as draw() does, in two steps, so that a film starts the next picture before it waits for this one. take()
  // hands over the oldest picture that was started and not taken; no more than picturesAhead() may wait when the next
  // one is started. The pages may go after start(). Nothing waits when draw() is called.
  // A picture whose start() is a fault is none; those before it can still be taken.
  virtual std::size_t picturesAhead() const { return 0; }
  virtual Status start(const scene::DrawList& list, std::span<const stream::Residency* const> sources);
  virtual Result<Image> take();

 private:
  Image started_;  // by a renderer that finishes a picture before it returns
};

// Side of the sample grid of a pixel (1, 2, 3 or 4), or a Fault (kUsage) if the format is not one the renderers serve.
Result<std::uint32_t> sampleGrid(const scene::Format& format);

// A surface's items page by page, in order. O(items).
std::vector<std::span<const scene::DrawItem>> itemsByPage(std::span<const scene::DrawItem> items);

// The Fault of a list that names a page which is not resident.
Fault absentPage(std::size_t page);

// The renderer in plain C++. threads: at least 1; the picture does not depend on it.
std::unique_ptr<Renderer> makeCpuRenderer(unsigned threads);

}  // namespace tet4d::render
