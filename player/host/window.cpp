#include "player/host/window.h"

#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "player/host/offscreen_gl.h"
#include "player/render/gl_renderer.h"

#if defined(TET4D_WITH_IMGUI) && defined(TET4D_HAS_GL)
#define TET4D_HAS_PANELS 1
#include "player/host/viewer_request.h"
#endif
#if defined(TET4D_HAS_PANELS) && defined(TET4D_WITH_GLFW)
#define TET4D_HAS_WINDOW 1
#endif

namespace tet4d::host {

#ifdef TET4D_HAS_PANELS

ViewerOptions viewerOptions(const PlayerRequest& request) {
  ViewerOptions options;
  options.width = request.width;
  options.height = request.height;
  options.samples = request.samples;
  options.smooth = request.smooth;
  options.budget_bytes = request.budget_bytes;
  options.directory = request.directory;
  options.threads = request.threads;
  options.shot = request.shot;
  options.fixed_scale = request.ui_scale.has_value();
  options.scale = request.ui_scale.value_or(1);
  return options;
}

namespace {

// The renderer of the scene, in the context that is current.
Result<std::unique_ptr<render::Renderer>> rendererOf(const PlayerRequest& request, render::GlResolver resolver) {
  if (request.renderer == "cpu") return render::makeCpuRenderer(request.threads);
  return render::makeGlRenderer(resolver, request.gpu_bytes);
}

}  // namespace

Status prepare(Viewer& viewer, const PlayerRequest& request, render::GlResolver resolver) {
  auto renderer = rendererOf(request, resolver);
  if (!renderer.ok()) return renderer.fault();
  if (Status status = viewer.start(resolver, std::move(renderer).value()); !status.ok()) return status;
  for (const std::string& file : request.files) {
    if (Status status = viewer.open(file); !status.ok()) return status;
    const std::size_t number = viewer.files().all().size() - 1;
    if (number < request.colorings.size()) viewer.files().all()[number]->coloring = request.colorings[number];
  }
  if (request.budget_ms) viewer.setBudget(*request.budget_ms, request.samples);
  if (request.time) viewer.state().timeline.setTime(*request.time);
  for (const char c : request.typed) {
    if (c == '\t' || c == '\x1b') {
      viewer.handle(KeyChanged{c == '\t' ? Key::kTab : Key::kEscape, true, false, false});
    } else {
      viewer.handle(Typed{static_cast<char32_t>(static_cast<unsigned char>(c))});
    }
  }
  return {};
}

#endif

bool hasPanels() {
#ifdef TET4D_HAS_PANELS
  return hasOffscreenGl();
#else
  return false;
#endif
}

bool hasWindow() {
#ifdef TET4D_HAS_WINDOW
  return true;
#else
  return false;
#endif
}

#ifndef TET4D_HAS_WINDOW

Status runWindow(const PlayerRequest&) {
  return Fault{FaultCode::kNotBuilt, "", "window",
               "this build has no window (TET4D_WITH_GLFW or TET4D_WITH_IMGUI is off)",
               "give --offscreen and -o frames/%05d.png, or build with -DTET4D_WITH_GLFW=ON -DTET4D_WITH_IMGUI=ON"};
}

#endif

#ifdef TET4D_HAS_PANELS

Result<render::Image> drawWithPanels(const PlayerRequest& request) {
  auto context = makeOffscreenContext();
  if (!context.ok()) return context.fault();
  Viewer viewer(viewerOptions(request));
  if (Status status = prepare(viewer, request, context.value()->resolver()); !status.ok()) return status.fault();
  // Until panels know their sizes and pages have come.
  while (viewer.frame(0.02).wait_s < 0.05) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return viewer.screenshot();
}

#else

Result<render::Image> drawWithPanels(const PlayerRequest&) {
  return Fault{FaultCode::kNotBuilt, "", "--panels",
               "this build has no panels (TET4D_WITH_IMGUI or TET4D_WITH_OSMESA is off)",
               "leave --panels out, or build with -DTET4D_WITH_IMGUI=ON -DTET4D_WITH_OSMESA=ON"};
}

#endif

}  // namespace tet4d::host
