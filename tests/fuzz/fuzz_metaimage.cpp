// Any bytes as a MetaImage file: header and, where they are small, the frames.
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/read_metaimage.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  constexpr std::uint64_t kMostBytes = 1 << 20, kMostFrames = 8;
  const fuzz::MemoryFile file(std::as_bytes(std::span(data, size)));
  try {
    exchange::MetaImageFile image(file.path());
    const std::uint64_t bytes = image.header().frameBytes();
    if (bytes > kMostBytes) return 0;
    std::vector<std::byte> samples(bytes);
    for (std::uint64_t k = 0; k < image.header().frames && k < kMostFrames; ++k) image.readFrame(k, samples);
  } catch (const Error&) {
    // Every refusal is one of these; anything else ends the run.
  }
  return 0;
}
