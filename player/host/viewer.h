// The player as a program people use, without its window: state, events in, pictures out.
//
// The window (window.h) and off-screen pictures with panels feed it events and show what it draws; tests do the same,
// so that what they see is what a user sees. One thread. Needs an OpenGL context that is current (or is made current by
// the caller) in start(), frame(), present() and the destructor.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "player/host/keys.h"
#include "player/host/recorder.h"
#include "player/host/timeline.h"
#include "player/host/viewer_files.h"
#include "player/render/gl_panels.h"
#include "player/scene/camera_control.h"
#include "player/scene/drawn_kinds.h"
#include "player/scene/frame_budget.h"

struct ImGuiContext;
struct ImDrawData;

namespace tet4d::host {

struct ViewerOptions {
  std::uint32_t width = 1280, height = 720;  // framebuffer, pixels
  double scale = 1;                          // pixels a unit of the panels
  bool fixed_scale = false;                  // whatever the display says of itself
  std::uint32_t samples = 4;                 // of a picture at rest; while something moves as many as the budget allows
  bool smooth = true, panels = true;
  std::uint64_t budget_bytes = std::uint64_t{1} << 30;  // of pages kept, of all files together
  unsigned threads = 2;
  std::string directory = ".";      // of what is saved
  std::optional<scene::Shot> shot;  // without: fitted to what is opened first
};

struct Message {
  std::string text, remedy;  // remedy may be empty
  bool is_error = false;
  double age_s = 0;
  int count = 1;  // the same said again
};

// What the panels change and show.
struct ViewerState {
  Timeline timeline;
  scene::Shot shot;
  std::uint32_t width = 1280, height = 720;
  double scale = 1;
  std::uint32_t samples = 4;
  double budget_ms = 50;  // of a picture while something moves
  bool smooth = true, panels = true, help = false, quit = false;
  bool legend = true;        // where colours mean something
  bool is_new = true;        // nobody has touched anything yet: a hint says what can be done
  std::size_t selected = 0;  // rank of the file whose colours are shown
  FilmKind film_kind = FilmKind::kPng;
  int film_between = 0;
  std::array<char, 1024> path_to_open{};  // as it is typed
  std::optional<double> film_fps;         // of a y4m; without: as fast as it is played
  std::vector<Message> messages;
  SceneStats stats;             // of the picture shown
  std::vector<float> frame_ms;  // of the last pictures, oldest first
  scene::Quality quality;       // of it
  scene::FrameBudget::Report budget;
  std::map<std::string, scene::Frame> places;  // where widgets stand, for tests: "play", "time line", …
};

class Viewer {
 public:
  explicit Viewer(const ViewerOptions& options);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  // Before the first frame(). The renderer draws the scene, wherever it likes.
  Status start(render::GlResolver resolver, std::unique_ptr<render::Renderer> renderer);

  // Adds a file, or reads it anew; a Fault changes nothing and is for the caller to show.
  Status open(const std::string& path);
  // Taken in order by the next frame().
  void handle(Event event);
  void act(Action action);

  struct Outcome {
    bool changed = false;  // there is something new to present()
    double wait_s = 0;     // frame() wants to be called again after that long even if nothing happens; may be infinite
  };
  // Lets `seconds` pass, takes the events, draws the scene if it changed and lays the panels out.
  Outcome frame(double seconds);

  // Draws what frame() made into a framebuffer of the present size (0: the window's).
  Status present(unsigned framebuffer);
  // Ends a film that is being recorded; what there is of it is kept. Before the viewer goes.
  void endRecording();
  // The same into a framebuffer of its own, read back; what the window's shows.
  Result<render::Image> screenshot();
  Result<render::Image> readWindow();
  // The next frame() changes something even if nothing happened.
  void wake() { settling_ = 1; }

  void say(const std::string& text);
  void report(const Fault& fault);

  const ViewerState& state() const { return state_; }
  ViewerState& state() { return state_; }
  ViewerFiles& files() { return files_; }
  const Recorder* recorder() const { return recorder_ ? &*recorder_ : nullptr; }
  const render::Image& picture() const { return picture_; }
  // The camera, lights, background and first file's material as they stand.
  scene::Shot shot() const;
  // Where the panels leave the picture free, pixels; and what data are fitted into: no legend stands there.
  scene::Frame freeFrame() const;
  scene::Frame fitFrame() const;

  // For the panels.
  void removeFile(std::size_t rank);
  void changed() { scene_changed_ = true; }
  void setBudget(double ms, std::uint32_t samples);
  void toggleFilm();
  // Pictures a second of a film begun now, kLeastFps .. kMostFps.
  double filmFps() const;
  static constexpr double kLeastFps = 1, kMostFps = 240;
  // What the window is called: after the file whose colours are shown.
  std::string title();
  // The file whose colours are shown, or null.
  ViewerFile* selected();

 private:
  // viewer_input.cpp
  static void mapKeys();
  void takeEvents();
  void takeEvent(const Event& event);
  void pointerMoved(const PointerMoved& event);
  void keyChanged(const KeyChanged& event);
  void resized(const Resized& event);
  void rescale(double scale);
  void pointInPicture();
  // viewer_actions.cpp
  void look(scene::StandardView side);
  void actOnTime(Action action);
  void actOnView(Action action);
  void actOnLook(Action action);
  void colorByNext();
  // viewer_saving.cpp
  bool recordPicture();
  void endFilm();
  void savePictureNow();
  void writeCamera();
  // viewer.cpp
  void filesChanged();
  void layOut(double seconds);
  bool isMoving() const;
  double legendRoom() const;
  void makeRoomForLegends();
  bool drawChanges(double seconds);
  bool drawScene(bool full);
  Result<render::Image> draw(double time, const scene::Format& format, bool whole, SceneStats& stats);
  Pace pace() const;
  void show(render::Image picture, const SceneStats& stats);
  void drawLegendOn(render::Image& image, bool whole) const;
  double waitSeconds() const;
  bool isMinimised() const { return state_.width == 0 || state_.height == 0; }
  glm::dvec2 pictureSize() const { return {state_.width, state_.height}; }

  ViewerOptions options_;
  ViewerState state_;
  ViewerFiles files_;
  scene::WorldBox box_;
  std::deque<Event> events_;
  ImGuiContext* gui_ = nullptr;
  ImDrawData* draw_data_ = nullptr;
  std::unique_ptr<render::Renderer> renderer_;
  std::unique_ptr<render::GlPanels> canvas_;
  render::Image picture_;
  std::optional<Recorder> recorder_;
  bool has_view_ = false, moved_by_hand_ = false;
  bool scene_changed_ = true, picture_is_full_ = false;
  scene::DrawnKinds kinds_;
  scene::FrameBudget budget_{50};
  scene::MotionQuality motion_{4};
  int settling_ = 3;       // frames the panels still need to come to rest
  double wheeled_s_ = 10;  // since the wheel last turned
  // The drag in the picture, if one is going on.
  enum class Drag : std::uint8_t { kNone, kTurn, kPan } drag_ = Drag::kNone;
  glm::dvec2 pointer_{-1, -1};  // pixels
  double wheel_ = 0;
  std::size_t scans_seen_ = 0;  // columns whose range the panels show
  double legend_room_ = 0;      // that the view was fitted beside
  std::optional<PointerButton> button_;
};

}  // namespace tet4d::host
