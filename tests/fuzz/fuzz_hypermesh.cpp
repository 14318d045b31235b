// Any bytes as a hypermesh file: opened, verified, read to the last number, and sliced.
#include "formats/hypermesh.h"
#include "tests/formats/support/dump.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  return fuzz::run(data, size, hypermesh::kPayload, [](const std::string& path) {
    // What verifies can be read to the end.
    auto file = hypermesh::File::open(path);
    if (!file.ok() || !file.value().verify().ok()) return;
    if (!test::dumpOf(path, hypermesh::kPayload).ok()) std::abort();
    for (const float t : {0.0f, 0.6f, file.value().header().domain.max.t}) {
      if (!test::dumpSlice(path, t).ok()) std::abort();
    }
  });
}
