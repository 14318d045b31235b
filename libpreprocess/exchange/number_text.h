// Numbers as text that reads back to the same bits, whatever the locale.
#pragma once

#include <charconv>
#include <string>

namespace tet4d::exchange {

// The shortest decimal text of a float or double: 0.1, 1e-09, nan.
template <class Float>
std::string numberText(Float number) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

}  // namespace tet4d::exchange
