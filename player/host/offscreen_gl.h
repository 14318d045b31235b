// An OpenGL context without a display, by Mesa's OSMesa; and the renderer in it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "player/render/gl_renderer.h"
#include "player/render/renderer.h"

namespace tet4d::host {

// True if this build can draw with OpenGL off-screen.
bool hasOffscreenGl();

// An OpenGL context, current on the thread that made it, until another one is made current.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual bool makeCurrent() = 0;
  virtual render::GlResolver resolver() const = 0;
};

// A context without a display, for what draws besides the renderer below. Fault kNotBuilt if this build has no OSMesa.
Result<std::unique_ptr<GlContext>> makeOffscreenContext();

// The renderer called `name` ("gl", "cpu" or "tets") for off-screen pictures. All but "cpu" make a context of its own
// and make it current on the calling thread whenever it draws. Fault kNotBuilt if this build has no OSMesa, kUsage for
// another name. threads: of the CPU renderer. gpu_budget_bytes: of page copies in the driver.
Result<std::unique_ptr<render::Renderer>> makeOffscreenRenderer(const std::string& name, unsigned threads,
                                                                std::uint64_t gpu_budget_bytes);

}  // namespace tet4d::host
