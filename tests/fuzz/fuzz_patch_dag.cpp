// Any bytes as a patch DAG: opened, verified, and read to the last number.
#include "formats/patch_dag.h"
#include "tests/formats/support/dump.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  return fuzz::run(data, size, patch_dag::kPayload, [](const std::string& path) {
    // What verifies can be read to the end.
    auto file = patch_dag::File::open(path);
    if (!file.ok() || !file.value().verify().ok()) return;
    if (!test::dumpOf(path, patch_dag::kPayload).ok()) std::abort();
  });
}
