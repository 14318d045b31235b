// Writes the files that the cases of tet4d-play.py run on into the directory named by the first argument.
#include <filesystem>
#include <fstream>
#include <vector>

#include "formats/hypermesh.h"
#include "tests/player/swept_mesh.h"
#include "tests/player/tet_soup.h"

namespace {

using namespace tet4d;

void copy(const std::string& made, const std::string& path) {
  std::filesystem::copy_file(made, path, std::filesystem::copy_options::overwrite_existing);
}

void write(const std::string& path, const std::vector<test::Page>& pages, const test::FileSpec& spec) {
  copy(test::writeFile("made.t4d", pages, spec), path);
}

// Two tetrahedra's worth of nothing: a hypermesh with an empty slab, to be refused by the player.
void writeHypermesh(const std::string& path) {
  const double times[] = {0, 1};
  hypermesh::MeshHeader header{};
  header.domain = {{0, 0, 0, 0}, {1, 1, 1, 1}};
  auto writer = hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true);
  if (!writer.ok()) throw std::runtime_error(writer.fault().what);
  const Status added = writer.value().addPage({}, {}, {}, {{0, 0, 0, 0}, {0, 0, 0, 1}});
  if (!added.ok()) throw std::runtime_error(added.fault().what);
  if (const Status closed = writer.value().close("{}"); !closed.ok()) throw std::runtime_error(closed.fault().what);
}

// Changes one bit of a page.
void damage(const std::string& path, std::size_t page) {
  const std::uint64_t offset = dyntri::File::open(path).value().pages().entries()[page].offset + 300;
  std::fstream bytes(path, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekg(static_cast<std::streamoff>(offset));
  const int old = bytes.get();
  bytes.seekp(static_cast<std::streamoff>(offset));
  bytes.put(static_cast<char>(old ^ 1));
}

}  // namespace

int main(int, char** argv) {
  const std::string directory = argv[1];
  std::filesystem::create_directories(directory);
  const test::Surface ball = test::icosphere(2);
  const auto motion = test::kTestSphere.motion();
  // Frames at 10.0, 10.5 and 12.0 seconds.
  write(directory + "/sphere.t4d", {test::sweep(ball, motion, 0, 1), test::sweep(ball, motion, 1, 2)},
        {{}, {10, 10.5, 12}, paged::Codec::kRaw});
  copy(test::writeColumnSphere("made.t4d", 4), directory + "/columns.t4d");
  copy(test::writeParts("made.t4d"), directory + "/parts.t4d");
  write(directory + "/empty.t4d", {}, {{}, {0, 1}, paged::Codec::kRaw});
  // Forty pages, the same compressed if this build can; the first ten of them with one damaged.
  std::vector<test::Page> many;
  std::vector<double> times{0};
  for (int k = 0; k < 40; ++k) {
    many.push_back(test::sweep(ball, motion, k, k + 1));
    times.push_back(k + 1);
  }
  write(directory + "/many.t4d", many, {{}, times, paged::Codec::kRaw});
  const bool has_zstd = paged::hasCodec(paged::Codec::kZstd);
  write(directory + "/packed.t4d", many, {{}, times, has_zstd ? paged::Codec::kZstd : paged::Codec::kRaw});
  many.resize(10);
  times.resize(11);
  write(directory + "/damaged.t4d", many, {{}, times, paged::Codec::kRaw});
  damage(directory + "/damaged.t4d", 4);
  writeHypermesh(directory + "/mesh.t4h");
  // The same as tetrahedra and as triangles.
  const test::Soup soup = test::soup(5, 400, 3);
  copy(test::writeHypermesh("made.t4h", soup, {0, 1, 2, 3}), directory + "/soup.t4h");
  write(directory + "/soup.t4d", {test::trianglesOf(soup)}, {{}, {0, 1, 2, 3}, paged::Codec::kRaw});
  return 0;
}
