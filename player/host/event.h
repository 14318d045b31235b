// What happens to the player from outside: the window's events, or a test's.
//
// Positions are in ImGui's units (framebuffer pixels over the display's scale), from the upper left.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace tet4d::host {

// Keys that type nothing; what types a character comes as Typed, so that the table of keys holds for every layout.
enum class Key : std::uint8_t {
  kNone,
  kLeft,
  kRight,
  kUp,
  kDown,
  kHome,
  kEnd,
  kEscape,
  kTab,
  kEnter,
  kBackspace,
  kDelete,
  kF1,
  kCount
};

struct PointerMoved {
  double x = 0, y = 0;
};
struct PointerButton {
  int button = 0;  // 0 left, 1 right, 2 middle
  bool down = false;
  bool shift = false;
};
struct Scrolled {
  double by = 0;  // notches, positive: away from the user
};
struct KeyChanged {
  Key key = Key::kNone;
  bool down = false;
  bool control = false, shift = false;
};
struct Typed {
  char32_t character = 0;
};
// The framebuffer's pixels; both 0 while the window is minimised. scale: pixels a unit.
struct Resized {
  std::uint32_t width = 0, height = 0;
  double scale = 1;
};
struct Dropped {
  std::vector<std::string> paths;
};

using Event = std::variant<PointerMoved, PointerButton, Scrolled, KeyChanged, Typed, Resized, Dropped>;

}  // namespace tet4d::host
