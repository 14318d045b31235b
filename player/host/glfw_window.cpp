// runWindow(): the viewer in a window of GLFW. Compiled where the build has GLFW, Dear ImGui and OpenGL.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "player/host/output_file.h"
#include "player/host/png.h"
#include "player/host/viewer_request.h"

namespace tet4d::host {
namespace {

constexpr double kLeastFrameSeconds = 0.004;  // where swapping buffers does not wait for the screen

std::string& lastGlfwError() {
  static std::string text;
  return text;
}

struct GlfwSession {
  bool ok = false;
  GlfwSession() {
    glfwSetErrorCallback([](int, const char* text) { lastGlfwError() = text; });
    ok = glfwInit() == GLFW_TRUE;
  }
  GlfwSession(const GlfwSession&) = delete;
  GlfwSession& operator=(const GlfwSession&) = delete;
  ~GlfwSession() {
    if (ok) glfwTerminate();
  }
};

struct DestroyWindow {
  void operator()(GLFWwindow* window) const { glfwDestroyWindow(window); }
};
using WindowPointer = std::unique_ptr<GLFWwindow, DestroyWindow>;

Fault noDisplay() {
  const char* display = std::getenv("DISPLAY");
  const std::string found =
      display == nullptr || *display == '\0' ? "DISPLAY is not set" : "DISPLAY is " + std::string(display);
  return {FaultCode::kIo, "", "window", "no display can be opened: " + found + " (" + lastGlfwError() + ")",
          "start it within a desktop, or draw without one: --offscreen -o frames/%05d.png"};
}

// The version that the display's OpenGL does have.
std::string versionFound() {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  const WindowPointer window(glfwCreateWindow(16, 16, "", nullptr, nullptr));
  if (window == nullptr) return "none";
  return std::to_string(glfwGetWindowAttrib(window.get(), GLFW_CONTEXT_VERSION_MAJOR)) + "." +
         std::to_string(glfwGetWindowAttrib(window.get(), GLFW_CONTEXT_VERSION_MINOR));
}

Result<WindowPointer> openGlfwWindow(const PlayerRequest& request) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);  // pictures come finished
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  // A window on a dense display is as large to the eye as on another.
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, request.ui_scale ? GLFW_FALSE : GLFW_TRUE);
  WindowPointer window(
      glfwCreateWindow(static_cast<int>(request.width), static_cast<int>(request.height), "tet4d", nullptr, nullptr));
  if (window != nullptr) return window;
  const std::string reason = lastGlfwError();
  return Fault{FaultCode::kIo, "", "window",
               "OpenGL 3.3 is needed, the display gives " + versionFound() + " (" + reason + ")",
               "give --renderer cpu --offscreen -o frames/%05d.png, which needs no OpenGL"};
}

Viewer& viewerOf(GLFWwindow* window) { return *static_cast<Viewer*>(glfwGetWindowUserPointer(window)); }

Key keyOf(int key) {
  switch (key) {
    case GLFW_KEY_LEFT:
      return Key::kLeft;
    case GLFW_KEY_RIGHT:
      return Key::kRight;
    case GLFW_KEY_UP:
      return Key::kUp;
    case GLFW_KEY_DOWN:
      return Key::kDown;
    case GLFW_KEY_HOME:
      return Key::kHome;
    case GLFW_KEY_END:
      return Key::kEnd;
    case GLFW_KEY_ESCAPE:
      return Key::kEscape;
    case GLFW_KEY_TAB:
      return Key::kTab;
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
      return Key::kEnter;
    case GLFW_KEY_BACKSPACE:
      return Key::kBackspace;
    case GLFW_KEY_DELETE:
      return Key::kDelete;
    case GLFW_KEY_F1:
      return Key::kF1;
    default:
      return Key::kNone;
  }
}

void tellSize(GLFWwindow* window) {
  int width = 0, height = 0, units = 0, unused = 0;
  glfwGetFramebufferSize(window, &width, &height);
  glfwGetWindowSize(window, &units, &unused);
  // Where a unit of the screen is a pixel, as in X11, a dense display says so by its content scale.
  float content = 1;
  glfwGetWindowContentScale(window, &content, nullptr);
  const double pixels_per_unit = units > 0 ? static_cast<double>(width) / units : 1;
  viewerOf(window).handle(Resized{static_cast<std::uint32_t>(std::max(0, width)),
                                  static_cast<std::uint32_t>(std::max(0, height)),
                                  std::max({1.0, pixels_per_unit, double{content}})});
}

// From the screen's units to the panels'.
glm::dvec2 panelUnits(GLFWwindow* window, double x, double y) {
  int width = 0, units = 0, unused = 0;
  glfwGetFramebufferSize(window, &width, &unused);
  glfwGetWindowSize(window, &units, &unused);
  const double factor = (units > 0 ? static_cast<double>(width) / units : 1) / viewerOf(window).state().scale;
  return {x * factor, y * factor};
}

void connect(GLFWwindow* window, Viewer& viewer) {
  glfwSetWindowUserPointer(window, &viewer);
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { tellSize(w); });
  glfwSetWindowContentScaleCallback(window, [](GLFWwindow* w, float, float) { tellSize(w); });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { tellSize(w); });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    const glm::dvec2 at = panelUnits(w, x, y);
    viewerOf(w).handle(PointerMoved{at.x, at.y});
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
    viewerOf(w).handle(PointerButton{button, action == GLFW_PRESS, (mods & GLFW_MOD_SHIFT) != 0});
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double by) { viewerOf(w).handle(Scrolled{by}); });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
    if (keyOf(key) == Key::kNone) return;
    viewerOf(w).handle(
        KeyChanged{keyOf(key), action != GLFW_RELEASE, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0});
  });
  glfwSetCharCallback(window,
                      [](GLFWwindow* w, unsigned character) { viewerOf(w).handle(Typed{char32_t{character}}); });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    Dropped dropped;
    for (int i = 0; i < count; ++i) dropped.paths.emplace_back(paths[i]);
    viewerOf(w).handle(std::move(dropped));
  });
}

// Sleeps until something happens or `wait_s` is over.
void waitForEvents(double wait_s, double frame_seconds) {
  const double wait = std::max(wait_s, kLeastFrameSeconds - frame_seconds);
  if (wait <= 0) {
    glfwPollEvents();
  } else if (std::isinf(wait)) {
    glfwWaitEvents();
  } else {
    glfwWaitEventsTimeout(wait);
  }
}

Status saveWindow(Viewer& viewer, const std::string& path) {
  if (Status status = viewer.present(0); !status.ok()) return status;
  auto image = viewer.readWindow();
  if (!image.ok()) return image.fault();
  const auto png = encodePng(image.value(), path);
  if (!png.ok()) return png.fault();
  return writeFile(path, png.value(), true);
}

Status loop(GLFWwindow* window, Viewer& viewer, const PlayerRequest& request) {
  double last = glfwGetTime();
  std::uint64_t shown = 0;
  std::string title;
  const auto isStopped = [&] { return request.stop && request.stop(); };
  while (glfwWindowShouldClose(window) == GLFW_FALSE && !viewer.state().quit && !isStopped()) {
    const double now = glfwGetTime();
    const Viewer::Outcome outcome = viewer.frame(now - last);
    last = now;
    if (std::string wanted = viewer.title(); wanted != title) {
      title = std::move(wanted);
      glfwSetWindowTitle(window, title.c_str());
    }
    if (outcome.changed) {
      if (Status status = viewer.present(0); !status.ok()) return status;
      ++shown;
      if (request.quit_after > 0 && shown >= request.quit_after) {
        return request.screenshot.empty() ? Status{} : saveWindow(viewer, request.screenshot);
      }
      glfwSwapBuffers(window);
    }
    const bool is_test = request.quit_after > 0;
    const double most_wait_s = is_test ? 0.05 : request.stop ? 0.2 : outcome.wait_s;
    waitForEvents(std::min(outcome.wait_s, most_wait_s), glfwGetTime() - now);
    // A test counts pictures also where nothing changes.
    if (is_test && !outcome.changed) viewer.wake();
  }
  viewer.endRecording();
  return {};
}

}  // namespace

Status runWindow(const PlayerRequest& request) {
  const GlfwSession glfw;
  if (!glfw.ok) return noDisplay();
  auto opened = openGlfwWindow(request);
  if (!opened.ok()) return opened.fault();
  const WindowPointer window = std::move(opened).value();
  glfwMakeContextCurrent(window.get());
  glfwSwapInterval(1);
  float content = 1;
  glfwGetWindowContentScale(window.get(), &content, nullptr);
  ViewerOptions options = viewerOptions(request);
  if (!options.fixed_scale) options.scale = std::max(1.0, double{content});
  Viewer viewer(options);
  connect(window.get(), viewer);
  tellSize(window.get());
  viewer.frame(0);  // takes the size before anything is fitted to it
  if (Status status = prepare(viewer, request, glfwGetProcAddress); !status.ok()) return status;
  Status status = loop(window.get(), viewer, request);
  // Callbacks may come until the window is gone; the viewer goes first.
  glfwSetWindowUserPointer(window.get(), nullptr);
  return status;
}

}  // namespace tet4d::host
