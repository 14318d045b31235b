// The OpenGL 3.3 core renderer: the paper's lookup shader on page data in buffer textures. Ponchio & Hormann 2008, 7.1.
#pragma once

#include <cstdint>
#include <memory>

#include "player/render/renderer.h"

namespace tet4d::render {

// Resolves the name of a GL function, as OSMesaGetProcAddress and glfwGetProcAddress do.
using GlResolver = void (*(*)(const char* name))();

// Where the normals of a smooth slice are summed: by the driver, with a geometry shader and additive blending, or in
// plain C++. kAuto: by the driver unless it has no GPU, where a point that is blended takes longer than its triangle.
enum class GlNormals : std::uint8_t { kAuto, kDriver, kPlain };

// Compiles the shaders in the context that is current on this thread; the renderer must be used and destroyed with the
// same context current. gpu_budget_bytes: of page copies kept between frames; a frame's own pages may exceed it.
// Fault kNotBuilt if the context has no OpenGL 3.3.
Result<std::unique_ptr<Renderer>> makeGlRenderer(GlResolver resolver, std::uint64_t gpu_budget_bytes,
                                                 GlNormals normals = GlNormals::kAuto);

// The paper's baseline: draws Residency::residentTets(), sliced by the vertex shader from indexed textures, each
// triangle with its own normal, in the surfaces' colours. Items name pages; their runs are not used. The rest as above.
Result<std::unique_ptr<Renderer>> makeTetRenderer(GlResolver resolver, std::uint64_t gpu_budget_bytes);

}  // namespace tet4d::render
