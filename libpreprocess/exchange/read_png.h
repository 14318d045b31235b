// Pictures as PNG, for comparing them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tet4d::exchange {

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4 * width * height bytes, straight alpha, rows from the top
};

// Any PNG, as 8-bit RGBA (16-bit channels lose their low bytes). Throws Error: kIo if it cannot be read, kBadInput for
// what is no PNG, is damaged or has more than 2^28 pixels. Memory: the file and 4 bytes a pixel.
Picture readPng(const std::string& path);

}  // namespace tet4d::exchange
