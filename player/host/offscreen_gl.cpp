#include "player/host/offscreen_gl.h"

#include <array>
#include <cstdlib>
#include <utility>

#ifdef TET4D_WITH_OSMESA
#include <GL/osmesa.h>
#endif

namespace tet4d::host {
namespace {

#ifdef TET4D_WITH_OSMESA

// A current context. Pictures are drawn into framebuffer objects, so its own buffer is a formality.
class OffscreenGl final : public GlContext {
 public:
  static std::unique_ptr<OffscreenGl> create() {
    // Mesa would write compiled shaders under the user's home.
    ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    constexpr std::array<int, 15> kAttributes{OSMESA_FORMAT,
                                              OSMESA_RGBA,
                                              OSMESA_DEPTH_BITS,
                                              0,
                                              OSMESA_STENCIL_BITS,
                                              0,
                                              OSMESA_ACCUM_BITS,
                                              0,
                                              OSMESA_PROFILE,
                                              OSMESA_CORE_PROFILE,
                                              OSMESA_CONTEXT_MAJOR_VERSION,
                                              3,
                                              OSMESA_CONTEXT_MINOR_VERSION,
                                              3,
                                              0};
    auto gl = std::make_unique<OffscreenGl>();
    gl->context_ = OSMesaCreateContextAttribs(kAttributes.data(), nullptr);
    return gl->context_ != nullptr && gl->makeCurrent() ? std::move(gl) : nullptr;
  }
  render::GlResolver resolver() const override { return OSMesaGetProcAddress; }
  bool makeCurrent() override {
    return OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, kSide, kSide) != GL_FALSE;
  }
  OffscreenGl() = default;
  OffscreenGl(const OffscreenGl&) = delete;
  OffscreenGl& operator=(const OffscreenGl&) = delete;
  ~OffscreenGl() override {
    if (context_ != nullptr) OSMesaDestroyContext(context_);
  }

 private:
  static constexpr int kSide = 16;  // pixels
  OSMesaContext context_ = nullptr;
  std::array<unsigned char, std::size_t{4} * kSide * kSide> pixels_{};
};

// Keeps the context alive for as long as the renderer that draws in it.
class OffscreenRenderer final : public render::Renderer {
 public:
  OffscreenRenderer(std::unique_ptr<OffscreenGl> gl, std::unique_ptr<render::Renderer> renderer)
      : gl_(std::move(gl)), renderer_(std::move(renderer)) {}
  OffscreenRenderer(const OffscreenRenderer&) = delete;
  OffscreenRenderer& operator=(const OffscreenRenderer&) = delete;
  ~OffscreenRenderer() override {
    // Names of GL objects mean something in their own context only.
    if (gl_->makeCurrent()) {
      renderer_.reset();
    } else {
      static_cast<void>(renderer_.release());  // the context takes its objects with it
    }
  }
  const char* name() const override { return renderer_->name(); }
  std::uint64_t gpuBytes() const override { return renderer_->gpuBytes(); }
  Result<render::Image> draw(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    if (!gl_->makeCurrent()) return lostContext();
    return renderer_->draw(list, sources);
  }
  std::size_t picturesAhead() const override { return renderer_->picturesAhead(); }
  Status start(const scene::DrawList& list, std::span<const stream::Residency* const> sources) override {
    return gl_->makeCurrent() ? renderer_->start(list, sources) : lostContext();
  }
  Result<render::Image> take() override {
    if (!gl_->makeCurrent()) return lostContext();
    return renderer_->take();
  }

 private:
  static Fault lostContext() { return {FaultCode::kIo, "", "OSMesa", "lost its context", "use --renderer cpu"}; }

  std::unique_ptr<OffscreenGl> gl_;  // first: destroyed after the renderer
  std::unique_ptr<render::Renderer> renderer_;
};

Fault noContext() {
  return {FaultCode::kNotBuilt, "", "OSMesa", "gives no OpenGL 3.3 core context", "use --renderer cpu"};
}

Result<std::unique_ptr<render::Renderer>> makeGl(bool tets, std::uint64_t gpu_budget_bytes) {
  auto gl = OffscreenGl::create();
  if (!gl) return noContext();
  auto renderer = tets ? render::makeTetRenderer(OSMesaGetProcAddress, gpu_budget_bytes)
                       : render::makeGlRenderer(OSMesaGetProcAddress, gpu_budget_bytes);
  if (!renderer.ok()) return renderer.fault();
  return std::unique_ptr<render::Renderer>(
      std::make_unique<OffscreenRenderer>(std::move(gl), std::move(renderer).value()));
}

#else

Fault notBuilt() {
  return {FaultCode::kNotBuilt, "", "renderer gl", "this build has no off-screen OpenGL (TET4D_WITH_OSMESA is off)",
          "use --renderer cpu, or build with -DTET4D_WITH_OSMESA=ON"};
}

Result<std::unique_ptr<render::Renderer>> makeGl(bool, std::uint64_t) { return notBuilt(); }

#endif

}  // namespace

bool hasOffscreenGl() {
#ifdef TET4D_WITH_OSMESA
  return true;
#else
  return false;
#endif
}

Result<std::unique_ptr<GlContext>> makeOffscreenContext() {
#ifdef TET4D_WITH_OSMESA
  auto gl = OffscreenGl::create();
  if (!gl) return noContext();
  return std::unique_ptr<GlContext>(std::move(gl));
#else
  return notBuilt();
#endif
}

Result<std::unique_ptr<render::Renderer>> makeOffscreenRenderer(const std::string& name, unsigned threads,
                                                                std::uint64_t gpu_budget_bytes) {
  if (name == "cpu") return render::makeCpuRenderer(threads);
  if (name == "gl" || name == "tets") return makeGl(name == "tets", gpu_budget_bytes);
  return Fault{FaultCode::kUsage, "", "renderer", "found \"" + name + "\", expected gl, cpu or tets",
               "give --renderer cpu"};
}

}  // namespace tet4d::host
