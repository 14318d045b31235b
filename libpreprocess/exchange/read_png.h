// Pictures as PNG, for comparing them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
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

// The same row by row, for pictures of any size. Memory: a row and the decoder's 100 KiB; of an interlaced PNG, whose
// rows are not complete before its end, the whole picture as above. Throws as above; kBadInput for rows of more than
// 2^26 pixels.
class PngRows {
 public:
  explicit PngRows(const std::string& path);
  PngRows(PngRows&&) noexcept;
  PngRows& operator=(PngRows&&) noexcept;
  ~PngRows();

  std::uint32_t width() const;
  std::uint32_t height() const;
  const std::string& path() const;
  // The next row from the top: 4 * width bytes, good until the next call. Call it `height` times at most.
  std::span<const std::uint8_t> next();

 private:
  struct Decoder;
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace tet4d::exchange
