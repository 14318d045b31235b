// Any bytes as a grid4 file: opened, verified, and read to the last number.
#include "formats/grid4.h"
#include "tests/formats/support/dump.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  return fuzz::run(data, size, grid4::kPayload, [](const std::string& path) {
    // What verifies can be read to the end.
    auto file = grid4::File::open(path);
    if (!file.ok() || !file.value().verify().ok()) return;
    if (!test::dumpOf(path, grid4::kPayload).ok()) std::abort();
  });
}
