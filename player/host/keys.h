// The one table of keys: the player obeys it, `?` shows it, docs/playing.md lists it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "player/host/event.h"

namespace tet4d::host {

enum class Action : std::uint8_t {
  kPlay,
  kStepBack,
  kStepForward,
  kFirst,
  kLast,
  kSlower,
  kFaster,
  kReverse,
  kLoop,
  kRangeBegin,
  kRangeEnd,
  kRangeAll,
  kFit,
  kThreeQuarter,
  kFront,
  kRight,
  kTop,
  kBack,
  kLeft,
  kBottom,
  kProjection,
  kSmooth,
  kNextColors,
  kLegend,
  kLit,
  kRoom,
  kDark,
  kSavePicture,
  kFilm,
  kWriteCamera,
  kPanels,
  kHelp,
  kClose,
  kQuit,
};

struct KeyBinding {
  Action action;
  Key key;             // kNone if a character stands for it
  char32_t character;  // 0 if a key stands for it
  const char* label;   // as a user reads it
  const char* group;
  const char* meaning;
};

// In the order in which they are shown; bindings of one group stand together.
std::span<const KeyBinding> keyTable();

// Null if nothing is bound.
const KeyBinding* bindingOf(Key key);
const KeyBinding* bindingOf(char32_t character);

// What the mouse does, as two columns: gesture, meaning.
struct Gesture {
  const char* label;
  const char* meaning;
};
std::span<const Gesture> gestures();

// The table as it stands in docs/playing.md.
std::string keysAsMarkdown();

}  // namespace tet4d::host
