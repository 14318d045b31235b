// Any bytes as a surface sequence: opened, verified, and read to the last number.
#include "formats/surface_sequence.h"
#include "tests/formats/support/dump.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  return fuzz::run(data, size, surface_sequence::kPayload, [](const std::string& path) {
    // What verifies can be read to the end.
    auto file = surface_sequence::File::open(path);
    if (!file.ok() || !file.value().verify().ok()) return;
    if (!test::dumpOf(path, surface_sequence::kPayload).ok()) std::abort();
  });
}
