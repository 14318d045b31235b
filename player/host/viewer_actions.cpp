// What the table of keys means: each Action, whether a key or a panel asks for it.
#include <imgui.h>

#include "player/host/panels.h"
#include "player/host/viewer.h"

namespace tet4d::host {

void Viewer::actOnTime(Action action) {
  Timeline& timeline = state_.timeline;
  if (recorder_) return;  // the film says what time it is
  scene_changed_ = true;
  switch (action) {
    case Action::kPlay:
      return timeline.play(!timeline.playing());
    case Action::kStepBack:
      return timeline.step(-1);
    case Action::kStepForward:
      return timeline.step(1);
    case Action::kFirst:
      return timeline.toBegin();
    case Action::kLast:
      return timeline.toEnd();
    case Action::kSlower:
      return timeline.setSpeed(timeline.speed() / 2);
    case Action::kFaster:
      return timeline.setSpeed(timeline.speed() * 2);
    case Action::kReverse:
      return timeline.setBackward(!timeline.backward());
    case Action::kLoop:
      return timeline.setLoop(timeline.loop() == Loop::kLoop       ? Loop::kPingPong
                              : timeline.loop() == Loop::kPingPong ? Loop::kOnce
                                                                   : Loop::kLoop);
    case Action::kRangeBegin:
      return timeline.setBegin(timeline.time());
    case Action::kRangeEnd:
      return timeline.setEnd(timeline.time());
    default:
      return timeline.wholeRange();
  }
}

void Viewer::look(scene::StandardView side) {
  state_.shot.view = scene::standardView(side, state_.shot.view, pictureSize(), fitFrame(), box_);
}

void Viewer::actOnView(Action action) {
  using scene::StandardView;
  if (files_.count() == 0 || state_.width == 0) return;
  scene_changed_ = true;
  moved_by_hand_ = action != Action::kFit;
  switch (action) {
    case Action::kFit:
      state_.shot.view = scene::fit(state_.shot.view, pictureSize(), fitFrame(), box_);
      return;
    case Action::kFront:
      return look(StandardView::kFront);
    case Action::kRight:
      return look(StandardView::kRight);
    case Action::kTop:
      return look(StandardView::kTop);
    case Action::kBack:
      return look(StandardView::kBack);
    case Action::kLeft:
      return look(StandardView::kLeft);
    case Action::kBottom:
      return look(StandardView::kBottom);
    case Action::kProjection:
      state_.shot.view = scene::toggleProjection(state_.shot.view, box_.centre);
      return;
    default:
      return look(StandardView::kThreeQuarter);
  }
}

// From the material by parts, if there are several, and each column to the material again.
void Viewer::colorByNext() {
  ViewerFile* file = selected();
  if (file == nullptr) return say("there is nothing to colour: drop a file on the window");
  scene::Coloring& coloring = file->coloring;
  const std::size_t columns = file->file.columns().size();
  const bool has_parts = file->file.parts().size() > 1;
  if (columns == 0 && !has_parts) return say(file->path + " has neither columns nor parts to colour by");
  if (coloring.by == scene::ColorBy::kMaterial && has_parts) {
    coloring.by = scene::ColorBy::kPart;
    return;
  }
  const std::size_t next = coloring.by == scene::ColorBy::kColumn ? coloring.column + 1 : 0;
  colorByColumn(*file, next);
}

void Viewer::actOnLook(Action action) {
  scene_changed_ = true;
  switch (action) {
    case Action::kSmooth:
      state_.smooth = !state_.smooth;
      return;
    case Action::kNextColors:
      return colorByNext();
    case Action::kLegend:
      state_.legend = !state_.legend;
      if (state_.legend && files_.legends().empty()) say("the legend explains colours by a column or by parts: c");
      return;
    case Action::kLit:
      if (ViewerFile* file = selected()) file->coloring.lit = !file->coloring.lit;
      return;
    case Action::kRoom:
      toggleRoom(state_.shot.background);
      return;
    default:
      toggleDark(state_.shot.background);
  }
}

void Viewer::act(Action action) {
  ImGui::SetCurrentContext(gui_);
  settling_ = 3;
  state_.is_new = false;
  if (action <= Action::kRangeAll) return actOnTime(action);
  if (action <= Action::kProjection) return actOnView(action);
  if (action <= Action::kDark) return actOnLook(action);
  switch (action) {
    case Action::kSavePicture:
      return savePictureNow();
    case Action::kFilm:
      return toggleFilm();
    case Action::kWriteCamera:
      return writeCamera();
    case Action::kPanels:
      state_.panels = !state_.panels;
      if (!moved_by_hand_ && !options_.shot) actOnView(Action::kFit);
      return;
    case Action::kHelp:
      state_.help = !state_.help;
      return;
    case Action::kClose:
      if (!state_.help && recorder_) toggleFilm();
      if (!state_.help) state_.messages.clear();
      state_.help = false;
      return;
    default:
      endRecording();
      state_.quit = true;
  }
}

}  // namespace tet4d::host
