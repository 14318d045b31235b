// Any bytes as a VTK image: the XML, the arrays' tables and, where they are small, the samples.
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/read_vti.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  constexpr std::uint64_t kMostBytes = 1 << 20;
  const fuzz::MemoryFile file(std::as_bytes(std::span(data, size)));
  try {
    const auto image = exchange::openVti(file.path(), "");
    const std::uint64_t bytes = image->header().frameBytes();
    if (bytes > kMostBytes) return 0;
    std::vector<std::byte> samples(bytes);
    image->readFrame(0, samples);
  } catch (const Error&) {
    // Every refusal is one of these; anything else ends the run.
  }
  return 0;
}
