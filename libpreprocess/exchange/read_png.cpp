#include "libpreprocess/exchange/read_png.h"

#include <spng.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 28;
constexpr std::uint32_t kMostRow = std::uint32_t{1} << 26;
constexpr std::size_t kMostChunk = std::size_t{64} << 20;

struct FreeContext {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

void check(int error, const std::string& path) {
  if (error == 0) return;
  throw Error(error == SPNG_EMEM ? FaultCode::kOutOfMemory : FaultCode::kBadInput, path, "",
              std::string("is no PNG that can be read: ") + spng_strerror(error), "give a PNG picture");
}

}  // namespace

Picture readPng(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw Error(FaultCode::kIo, path, "", "cannot be read", "check the name");
  const std::unique_ptr<spng_ctx, FreeContext> context(spng_ctx_new(0));
  if (!context) throw Error(FaultCode::kOutOfMemory, path, "", "no memory for a decoder", "");
  check(spng_set_chunk_limits(context.get(), kMostChunk, 2 * kMostChunk), path);
  check(spng_set_png_buffer(context.get(), bytes.data(), bytes.size()), path);
  spng_ihdr header{};
  check(spng_get_ihdr(context.get(), &header), path);
  if (std::uint64_t{header.width} * header.height > kMostPixels) {
    throw Error(FaultCode::kBadInput, path, "",
                "has " + std::to_string(header.width) + "x" + std::to_string(header.height) + " pixels, more than 2^28",
                "give a smaller picture");
  }
  Picture picture{header.width, header.height,
                  std::vector<std::uint8_t>(std::size_t{4} * header.width * header.height)};
  check(spng_decode_image(context.get(), picture.rgba.data(), picture.rgba.size(), SPNG_FMT_RGBA8, SPNG_DECODE_TRNS),
        path);
  return picture;
}

struct PngRows::Decoder {
  std::string path;
  std::unique_ptr<std::FILE, CloseFile> file;
  std::unique_ptr<spng_ctx, FreeContext> context;
  std::uint32_t width = 0, height = 0, done = 0;
  std::vector<std::uint8_t> row;
  Picture whole;  // if interlaced
};

PngRows::PngRows(const std::string& path) : decoder_(std::make_unique<Decoder>()) {
  Decoder& d = *decoder_;
  d.path = path;
  d.file.reset(std::fopen(path.c_str(), "rb"));
  if (!d.file) throw Error(FaultCode::kIo, path, "", "cannot be read", "check the name");
  d.context.reset(spng_ctx_new(0));
  if (!d.context) throw Error(FaultCode::kOutOfMemory, path, "", "no memory for a decoder", "");
  check(spng_set_chunk_limits(d.context.get(), kMostChunk, 2 * kMostChunk), path);
  check(spng_set_png_file(d.context.get(), d.file.get()), path);
  spng_ihdr header{};
  check(spng_get_ihdr(d.context.get(), &header), path);
  d.width = header.width;
  d.height = header.height;
  if (header.interlace_method != 0) {
    d.whole = readPng(path);
    return;
  }
  if (d.width > kMostRow) {
    throw Error(FaultCode::kBadInput, path, "", "has rows of " + std::to_string(d.width) + " pixels, more than 2^26",
                "give a smaller picture");
  }
  d.row.resize(std::size_t{4} * d.width);
  check(spng_decode_image(d.context.get(), nullptr, 0, SPNG_FMT_RGBA8, SPNG_DECODE_TRNS | SPNG_DECODE_PROGRESSIVE),
        path);
}

PngRows::PngRows(PngRows&&) noexcept = default;
PngRows& PngRows::operator=(PngRows&&) noexcept = default;
PngRows::~PngRows() = default;

std::uint32_t PngRows::width() const { return decoder_->width; }
std::uint32_t PngRows::height() const { return decoder_->height; }
const std::string& PngRows::path() const { return decoder_->path; }

std::span<const std::uint8_t> PngRows::next() {
  Decoder& d = *decoder_;
  const std::size_t bytes = std::size_t{4} * d.width;
  const std::uint32_t rank = d.done++;
  if (!d.whole.rgba.empty()) return std::span(d.whole.rgba).subspan(rank * bytes, bytes);
  const int error = spng_decode_row(d.context.get(), d.row.data(), bytes);
  if (error != SPNG_EOI || rank + 1 < d.height) check(error, d.path);
  return d.row;
}

}  // namespace tet4d::exchange
