#include "libpreprocess/exchange/read_png.h"

#include <spng.h>

#include <fstream>
#include <iterator>
#include <memory>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 28;
constexpr std::size_t kMostChunk = std::size_t{64} << 20;

struct FreeContext {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
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

}  // namespace tet4d::exchange
