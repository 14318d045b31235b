#include "player/host/keys.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace tet4d::host {
namespace {

constexpr auto kKeys = std::to_array<KeyBinding>({
    {Action::kPlay, Key::kNone, U' ', "Space", "Time", "play or pause"},
    {Action::kStepBack, Key::kLeft, 0, "Left", "Time", "to the frame before"},
    {Action::kStepForward, Key::kRight, 0, "Right", "Time", "to the next frame"},
    {Action::kFirst, Key::kHome, 0, "Home", "Time", "to the begin of the range"},
    {Action::kLast, Key::kEnd, 0, "End", "Time", "to the end of the range"},
    {Action::kSlower, Key::kNone, U'[', "[", "Time", "half as fast"},
    {Action::kFaster, Key::kNone, U']', "]", "Time", "twice as fast"},
    {Action::kReverse, Key::kNone, U'r', "r", "Time", "play the other way"},
    {Action::kLoop, Key::kNone, U'l', "l", "Time", "at the end: again, turn, or stop"},
    {Action::kRangeBegin, Key::kNone, U'i', "i", "Time", "the range begins here"},
    {Action::kRangeEnd, Key::kNone, U'o', "o", "Time", "the range ends here"},
    {Action::kRangeAll, Key::kNone, U'a', "a", "Time", "the range is everything"},
    {Action::kFit, Key::kNone, U'f', "f", "View", "fit everything into the picture"},
    {Action::kThreeQuarter, Key::kNone, U'0', "0", "View", "from the front right, above"},
    {Action::kFront, Key::kNone, U'1', "1", "View", "from the front"},
    {Action::kRight, Key::kNone, U'2', "2", "View", "from the right"},
    {Action::kTop, Key::kNone, U'3', "3", "View", "from the top"},
    {Action::kBack, Key::kNone, U'4', "4", "View", "from the back"},
    {Action::kLeft, Key::kNone, U'5', "5", "View", "from the left"},
    {Action::kBottom, Key::kNone, U'6', "6", "View", "from the bottom"},
    {Action::kProjection, Key::kNone, U'p', "p", "View", "perspective or orthographic"},
    {Action::kSmooth, Key::kNone, U'n', "n", "Look", "smooth or flat normals"},
    {Action::kNextColors, Key::kNone, U'c', "c", "Look", "colours: next column, parts, plain"},
    {Action::kLegend, Key::kNone, U'k', "k", "Look", "legend of the colours, or none"},
    {Action::kLit, Key::kNone, U'u', "u", "Look", "with light, or plain colours"},
    {Action::kRoom, Key::kNone, U'b', "b", "Look", "walls behind the data, or none"},
    {Action::kDark, Key::kNone, U'd', "d", "Look", "light or dark background"},
    {Action::kSavePicture, Key::kNone, U's', "s", "Save", "the picture, as PNG"},
    {Action::kFilm, Key::kNone, U'v', "v", "Save", "the range as a film, or stop it"},
    {Action::kWriteCamera, Key::kNone, U'w', "w", "Save", "the camera, for --camera"},
    {Action::kPanels, Key::kTab, 0, "Tab", "Window", "show or hide the panels"},
    {Action::kHelp, Key::kNone, U'?', "?", "Window", "this list"},
    {Action::kHelp, Key::kF1, 0, "F1", "Window", "this list"},
    {Action::kClose, Key::kEscape, 0, "Esc", "Window", "close list, messages, stop film"},
    {Action::kQuit, Key::kNone, U'q', "q", "Window", "quit"},
});

constexpr auto kGestures = std::to_array<Gesture>({
    {"drag", "turn"},
    {"right drag, Shift + drag", "move"},
    {"wheel", "zoom about the cursor"},
    {"drag the time line", "scrub"},
    {"drop files", "open them"},
});

}  // namespace

std::span<const KeyBinding> keyTable() { return kKeys; }
std::span<const Gesture> gestures() { return kGestures; }

const KeyBinding* bindingOf(Key key) {
  const auto* at = std::find_if(kKeys.begin(), kKeys.end(), [&](const KeyBinding& b) { return b.key == key; });
  return key == Key::kNone || at == kKeys.end() ? nullptr : at;
}

const KeyBinding* bindingOf(char32_t character) {
  const auto* at =
      std::find_if(kKeys.begin(), kKeys.end(), [&](const KeyBinding& b) { return b.character == character; });
  return character == 0 || at == kKeys.end() ? nullptr : at;
}

std::string keysAsMarkdown() {
  std::string text = "| key | does |\n|---|---|\n";
  const char* group = "";
  for (const KeyBinding& binding : kKeys) {
    if (std::string_view(group) != binding.group) text += "| **" + std::string(binding.group) + "** | |\n";
    group = binding.group;
    text += "| `" + std::string(binding.label) + "` | " + binding.meaning + " |\n";
  }
  text += "| **Mouse** | |\n";
  for (const Gesture& gesture : kGestures) text += "| " + std::string(gesture.label) + " | " + gesture.meaning + " |\n";
  return text;
}

}  // namespace tet4d::host
