// Any bytes as a stream of NRRDs: headers and, where they are small, the frames.
#include <fcntl.h>
#include <unistd.h>

#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/frame_stream.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  constexpr std::uint64_t kMostBytes = 1 << 20, kMostFrames = 8;
  const fuzz::MemoryFile file(std::as_bytes(std::span(data, size)));
  const int descriptor = ::open(file.path().c_str(), O_RDONLY | O_CLOEXEC);
  try {
    const auto source = exchange::openFrameStream(descriptor, "stream", {});
    if (source->grid().frameBytes() <= kMostBytes) {
      std::vector<std::byte> samples(source->grid().frameBytes());
      for (std::size_t k = 0; k < kMostFrames && source->hasFrame(k); ++k) source->readFrame(k, samples);
    }
  } catch (const Error&) {
    // Every refusal is one of these; anything else ends the run.
  }
  ::close(descriptor);
  return 0;
}
