// Draws a finished picture and, over it, what Dear ImGui wants drawn: the window's and the off-screen panels' last
// pass.
//
// Dear ImGui's own OpenGL backend brings a loader that knows windows only; this pass uses the renderer's loader, so
// that panels look the same in a window and off-screen. Colours are taken as they are (sRGB in, sRGB out).
#pragma once

#include <cstdint>
#include <memory>

#include "player/render/gl_renderer.h"

struct ImDrawData;

namespace tet4d::render {

class GlPanels {
 public:
  // Compiles its shaders in the context that is current on this thread and uploads the font atlas of the current ImGui
  // context; to be used and destroyed with the same contexts current. Fault kNotBuilt if there is no OpenGL 3.3.
  static Result<std::unique_ptr<GlPanels>> create(GlResolver resolver);
  ~GlPanels();
  GlPanels(const GlPanels&) = delete;
  GlPanels& operator=(const GlPanels&) = delete;

  // The font atlas changed.
  void uploadFonts();
  // The picture behind the panels, kept until the next call; stretched to the framebuffer if the sizes differ.
  Status setPicture(const Image& picture);

  // Fills `framebuffer` (0: the window's) of width x height pixels with picture and panels. `panels` may be null.
  // Framebuffer pixels are ImGui's units times its FramebufferScale.
  Status draw(const ImDrawData* panels, unsigned framebuffer, std::uint32_t width, std::uint32_t height);
  // The same into a framebuffer of its own, read back.
  Result<Image> drawOffscreen(const ImDrawData* panels, std::uint32_t width, std::uint32_t height);
  // What a framebuffer shows now.
  Result<Image> read(unsigned framebuffer, std::uint32_t width, std::uint32_t height);

 private:
  GlPanels();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tet4d::render
