// Any bytes as one file of a surface, by every scan, or as a sequence.json beside sound arrays. OpenMesh, which reads
// only what a scan has passed, is not called.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_scan.h"
#include "libpreprocess/exchange/surface_source.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

using namespace tet4d;

// A directory of two frames of four vertices and two triangles, in every type; gone at the end.
class Arrays {
 public:
  Arrays() : directory_(std::filesystem::temp_directory_path() / ("fuzz_surface." + std::to_string(::getpid()))) {
    std::filesystem::create_directory(directory_);
    const std::vector<std::uint32_t> triangles{0, 1, 2, 1, 3, 2};
    write("t.i32", std::as_bytes(std::span(triangles)));
    write("v.i16", std::vector<std::byte>(48));
    write("v.f32", std::vector<std::byte>(96));
    write("v.f64", std::vector<std::byte>(192));
  }
  ~Arrays() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;
  std::string write(const std::string& name, std::span<const std::byte> bytes) const {
    const auto path = directory_ / name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path.string();
  }

 private:
  std::filesystem::path directory_;
};

template <class Target>
void survive(Target target) {
  try {
    target();
  } catch (const Error&) {
    // Every refusal is one of these; anything else ends the run.
  }
}

void readArrays(std::span<const std::byte> json) {
  constexpr std::size_t kMostFrames = 8;
  static const Arrays arrays;
  const auto source = exchange::openSurfaceArrays(arrays.write("sequence.json", json), {});
  std::vector<Vec3f> positions(source->info().vertices);
  for (std::size_t k = 0; k < std::min(kMostFrames, source->info().times.size()); ++k) source->readFrame(k, positions);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::string path = "fuzz";
  for (const auto scan : {exchange::scanObj, exchange::scanOff, exchange::scanPly, exchange::scanStl})
    survive([&] { scan(text, path); });
  // A description begins with a brace; others would only cost time.
  if (text.starts_with('{')) survive([&] { readArrays(std::as_bytes(std::span(data, size))); });
  return 0;
}
