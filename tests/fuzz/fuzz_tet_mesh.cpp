// Any bytes as a mesh of tetrahedra in every format; of TetGen's two files the second begins behind a line "%".
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/tet_mesh_formats.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

using namespace tet4d;

template <class Target>
void survive(Target target) {
  try {
    target();
  } catch (const Error&) {
    // Every refusal is one of these; anything else ends the run.
  }
}

// X.node and X.ele; gone at the end.
struct TetgenFiles {
  std::string stem =
      (std::filesystem::temp_directory_path() / ("fuzz_tet_mesh." + std::to_string(::getpid()))).string();
  TetgenFiles() = default;
  TetgenFiles(const TetgenFiles&) = delete;
  TetgenFiles& operator=(const TetgenFiles&) = delete;
  ~TetgenFiles() {
    std::error_code ignored;
    for (const char* suffix : {".node", ".ele"}) std::filesystem::remove(stem + suffix, ignored);
  }
};

void readTetgen(std::string_view nodes, std::string_view elements) {
  static const TetgenFiles files;
  std::ofstream(files.stem + ".node", std::ios::binary) << nodes;
  std::ofstream(files.stem + ".ele", std::ios::binary) << elements;
  exchange::readTetgen(files.stem + ".node", {"z", false});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(std::as_bytes(std::span(data, size)));
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const exchange::TetMeshOptions options{"z", (size & 1) != 0};
  for (const auto read : {exchange::readVtu, exchange::readMedit, exchange::readGmsh})
    survive([&] { read(file.path(), options); });
  if (const std::size_t cut = text.find("\n%\n"); cut != std::string_view::npos)
    survive([&] { readTetgen(text.substr(0, cut), text.substr(cut + 3)); });
  return 0;
}
