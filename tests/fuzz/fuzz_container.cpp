// Any bytes as a container and its pages, whatever the payload.
#include "formats/paged.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tet4d;
  return fuzz::run(data, size, container::fourCc("FUZZ"), [](const std::string& path) {
    const auto peeked = container::peek(path);
    auto opened = container::Reader::open(path, 0, 0, {});
    if (peeked.ok() != opened.ok()) std::abort();
    if (!opened.ok()) return;
    const container::Reader& reader = opened.value();
    for (const auto& section : reader.sections()) {
      if (reader.find(section.kind) != &section) std::abort();
      container::fourCcText(section.kind);
    }
    reader.provenance();
    const bool sound = reader.verifyAll().ok();
    auto pages = paged::Pages::open(reader);
    if (!pages.ok()) return;
    for (std::size_t i = 0; i < pages.value().size(); ++i) {
      auto page = pages.value().load(i);
      if (page.ok() && page.value().bytes().size() != pages.value().entries()[i].raw_bytes) std::abort();
    }
    if (sound && !pages.value().verifyPadding().ok()) return;
  });
}
