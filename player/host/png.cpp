#include "player/host/png.h"

#include <spng.h>

#include <cstdlib>
#include <cstring>
#include <memory>

namespace tet4d::host {
namespace {

struct FreeContext {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
struct FreeBuffer {
  void operator()(void* buffer) const { std::free(buffer); }
};

std::vector<unsigned char> rgbOf(const render::Image& image) {
  std::vector<unsigned char> rgb(std::size_t{3} * image.width * image.height);
  for (std::size_t i = 0; i < rgb.size() / 3; ++i) std::memcpy(rgb.data() + 3 * i, image.rgba.data() + 4 * i, 3);
  return rgb;
}

}  // namespace

Result<std::vector<std::byte>> encodePng(const render::Image& image, const std::string& name) {
  const auto fault = [&](int error) {
    const FaultCode code = error == SPNG_EMEM ? FaultCode::kOutOfMemory : FaultCode::kIo;
    return Fault{code, name, "", std::string("cannot be encoded as PNG: ") + spng_strerror(error), ""};
  };
  const std::unique_ptr<spng_ctx, FreeContext> context(spng_ctx_new(SPNG_CTX_ENCODER));
  if (!context) return fault(SPNG_EMEM);
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, 6);
  spng_ihdr header{};
  header.width = image.width;
  header.height = image.height;
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR;
  spng_set_ihdr(context.get(), &header);
  spng_set_srgb(context.get(), 0);  // perceptual
  const std::vector<unsigned char> rgb = rgbOf(image);
  int error = spng_encode_image(context.get(), rgb.data(), rgb.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  if (error != 0) return fault(error);
  std::size_t size = 0;
  const std::unique_ptr<void, FreeBuffer> buffer(spng_get_png_buffer(context.get(), &size, &error));
  if (!buffer) return fault(error);
  std::vector<std::byte> bytes(size);
  std::memcpy(bytes.data(), buffer.get(), size);
  return bytes;
}

}  // namespace tet4d::host
