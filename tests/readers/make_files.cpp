// Writes, into a folder, every sample file, odd but legal variants of each and every forged one, and beside each good
// file what the C++ reader understands: FILE.dump, FILE.pages, and FILE.slices for a hypermesh. compare.py holds the
// Python readers to it.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/formats/support/bad_files.h"
#include "tests/formats/support/dump.h"
#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace {

using namespace tet4d;

bool say(const Fault& fault) {
  std::fprintf(stderr, "make_files: %s: %s: %s\n", fault.file.c_str(), fault.place.c_str(), fault.what.c_str());
  return false;
}

bool writeText(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  return static_cast<bool>(file.flush());
}

// At frames' times, the last one among them, between them, and outside.
constexpr float kTimes[] = {-1, 0, 0.25f, 0.5f, 0.6f, 0.75f, 1, 1.3f, 2, 3};

bool describe(const std::string& path, std::uint32_t payload) {
  auto dump = test::dumpOf(path, payload);
  if (!dump.ok()) return say(dump.fault());
  auto pages = test::pageDigestOf(path);
  if (!pages.ok()) return say(pages.fault());
  if (!writeText(path + ".dump", dump.value()) || !writeText(path + ".pages", pages.value())) return false;
  if (payload != hypermesh::kPayload) return true;
  std::string slices;
  for (const float t : kTimes) {
    auto slice = test::dumpSlice(path, t);
    if (!slice.ok()) return say(slice.fault());
    slices += slice.value();
  }
  return writeText(path + ".slices", slices);
}

bool makeAll(const std::string& folder) {
  std::filesystem::create_directories(folder + "/good");
  std::filesystem::create_directories(folder + "/bad");
  std::mt19937 random(7);
  for (const test::Sample& sample : test::samples()) {
    const std::string path = folder + "/good/" + sample.name;
    if (Status s = sample.write(path); !s.ok()) return say(s.fault());
    if (!describe(path, sample.payload)) return false;
    const test::Layout layout = test::Layout::of(path);
    for (int variant = 0; variant < 3; ++variant) {
      const std::string odd = folder + "/good/odd" + std::to_string(variant) + "_" + sample.name;
      test::writeBytes(odd, layout.oddly(random));
      if (!describe(odd, sample.payload)) return false;
    }
  }
  for (auto list : {test::badTables(), test::badContents()}) {
    for (const test::BadFile& bad : list) test::writeBytes(folder + "/bad/" + bad.name, test::bytesOf(bad));
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_files FOLDER\n");
    return 2;
  }
  return makeAll(argv[1]) ? 0 : 1;
}
