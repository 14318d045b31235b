// Writes small files of every payload, sound and unsound, for the cases: cli-files DIRECTORY.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <vector>

#include "formats/dynamic_triangles.h"
#include "formats/grid4.h"
#include "formats/hypermesh.h"
#include "formats/surface_sequence.h"

namespace {

using namespace tet4d;

constexpr const char* kProvenance = R"({"program": "cli-files", "inputs": []})";

void must(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "cli-files: %s: %s: %s\n", status.fault().file.c_str(), status.fault().place.c_str(),
               status.fault().what.c_str());
  std::exit(1);
}
template <class T>
T must(Result<T> result) {
  if (!result.ok()) must(Status(result.fault()));
  return std::move(result).value();
}

// 3 x 2 x 2 samples, two frames at 10 s and 20 s, cells of 0.5, origin (1, 2, 3).
void writeGrid(const std::string& path) {
  grid4::GridHeader header{};
  header.dims[0] = 3, header.dims[1] = 2, header.dims[2] = 2;
  header.frames = 2;
  header.sample_type = static_cast<std::uint32_t>(SampleType::kU8);
  header.index_to_world = {{1, 2, 3}, {{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}}};
  const std::vector<double> times{10, 20};
  auto writer = must(grid4::Writer::create(path, header, times, paged::Codec::kRaw, true));
  const std::vector<std::byte> samples(12, std::byte{7});
  for (int frame = 0; frame < 2; ++frame) must(writer.addFrame(samples));
  must(writer.close(kProvenance));
}

// Five corners in space-time, or none; the tetrahedra are those of the caller.
void writeMesh(const std::string& path, const std::vector<hypermesh::Tet>& tets, std::uint32_t flags) {
  std::vector<Vec4f> vertices{{0, 0, 0, 0.25F}, {2, 0, 0, 0.5F}, {0, 2, 0, 0.75F}, {1, 1, 1, 0}, {1, 1, -1, 1}};
  if (tets.empty()) vertices.clear();
  hypermesh::MeshHeader header{};
  header.flags = flags;
  header.domain = {{-4, -4, -4, 0}, {4, 4, 4, 1}};
  header.isovalue = std::numeric_limits<double>::quiet_NaN();
  header.index_to_world = AffineMap{};
  const std::vector<double> times{0, 2};
  auto writer = must(hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true));
  Bounds4f bounds = vertices.empty() ? Bounds4f{{0, 0, 0, 0}, {0, 0, 0, 1}} : Bounds4f{};
  for (const Vec4f& vertex : vertices) bounds.add(vertex);
  must(writer.addPage(vertices, {}, tets, bounds));
  must(writer.close(kProvenance));
}

// Two parts: the mesh of writeMesh, and its first tetrahedron once more.
void writeParts(const std::string& path) {
  const std::vector<Vec4f> vertices{{0, 0, 0, 0.25F}, {2, 0, 0, 0.5F}, {0, 2, 0, 0.75F}, {1, 1, 1, 0}, {1, 1, -1, 1}};
  hypermesh::MeshHeader header{};
  header.domain = {{-4, -4, -4, 0}, {4, 4, 4, 1}};
  header.isovalue = std::numeric_limits<double>::quiet_NaN();
  header.index_to_world = AffineMap{};
  const std::vector<double> times{0, 2}, isovalues{0.25, 0.75};
  auto writer = must(hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true, isovalues));
  Bounds4f bounds;
  for (const Vec4f& vertex : vertices) bounds.add(vertex);
  must(writer.addPage(vertices, {}, std::vector<hypermesh::Tet>{{0, 1, 2, 3}, {1, 0, 2, 4}}, bounds, {}, 0));
  must(writer.addPage(vertices, {}, std::vector<hypermesh::Tet>{{0, 1, 2, 3}}, bounds, {}, 1));
  must(writer.close(kProvenance));
}

// The first tetrahedron of writeMesh with the columns `normal`, `velocity` and `heat`, far from the world's origin.
void writeColumns(const std::string& path) {
  const std::vector<Vec4f> vertices{{0, 0, 0, 0.25F}, {2, 0, 0, 0.5F}, {0, 2, 0, 0.75F}, {1, 1, 1, 0}};
  hypermesh::MeshHeader header{};
  header.domain = {{-4, -4, -4, 0}, {4, 4, 4, 1}};
  header.isovalue = std::numeric_limits<double>::quiet_NaN();
  header.index_to_world = {{500000, 52000000, 0}, AffineMap{}.axes};
  const std::vector<double> times{0, 2};
  const std::vector<hypermesh::Writer::Column> columns{{"normal", 3}, {"velocity", 3}, {"heat", 1}};
  auto writer = must(hypermesh::Writer::create(path, header, times, columns, paged::Codec::kRaw, true));
  Bounds4f bounds;
  for (const Vec4f& vertex : vertices) bounds.add(vertex);
  const std::vector<float> normals{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1}, velocity(12, 2.5F), heat{1, 2, 3, 4};
  const std::vector<std::span<const float>> values{normals, velocity, heat};
  must(writer.addPage(vertices, {}, std::vector<hypermesh::Tet>{{0, 1, 2, 3}}, bounds, values));
  must(writer.close(kProvenance));
}

// One triangle on three edges, alive in [0, 1].
void writeTriangles(const std::string& path) {
  const std::vector<Vec4f> vertices{{0, 0, 0, 0}, {1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
  const std::vector<dyntri::Edge> edges{{0, 1}, {0, 2}, {0, 3}};
  const std::vector<dyntri::Lifespan> lifespans{{0, 1}};
  const std::vector<dyntri::Triangle> triangles{{0, 1, 2}};
  dyntri::Header header{};
  header.index_to_world = AffineMap{};
  header.last_time = 1;
  const std::vector<double> times{0, 1};
  auto writer = must(dyntri::Writer::create(path, header, times, paged::Codec::kRaw, true));
  // A tetrahedron with one early vertex: of its four triangles three have an empty life.
  must(writer.addPage({vertices, edges, lifespans, triangles}, 1, 3));
  must(writer.close(kProvenance));
}

// A triangle whose tip rises from 1 to 3 in two seconds, 10 km from the origin.
void writeSurface(const std::string& path) {
  surface_sequence::Header header{};
  header.vertices = 3;
  header.index_to_world = {{10000, 0, 0}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  const std::vector<double> times{0, 2};
  const std::vector<surface_sequence::Triangle> triangles{{0, 1, 2}};
  auto writer = must(surface_sequence::Writer::create(path, header, times, triangles, {}, paged::Codec::kRaw, true));
  for (const float top : {1.0F, 3.0F}) must(writer.addFrame(std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, top, 0}}));
  must(writer.close(kProvenance));
}

std::vector<char> bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void writeBytes(const std::string& path, const std::vector<char>& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// A copy with one bit of the first page's vertices turned over.
void damagePage(const std::string& from, const std::string& to) {
  const auto file = must(hypermesh::File::open(from));
  const paged::PageEntry& entry = file.geometryEntry(0);
  std::vector<char> bytes = bytesOf(from);
  bytes.at(entry.offset + sizeof(hypermesh::PageHeader)) ^= 1;
  writeBytes(to, bytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("cli-files: give a directory\n", stderr), 2;
  const std::filesystem::path directory = argv[1];
  std::filesystem::create_directories(directory);
  const auto in = [&](const char* name) { return (directory / name).string(); };

  writeGrid(in("grid.t4g"));
  writeTriangles(in("triangles.t4d"));
  writeSurface(in("surface.t4q"));
  // Faces opposite 3 and 4 are the same triangle, wound oppositely: sound.
  writeMesh(in("mesh.t4h"), {{0, 1, 2, 3}, {1, 0, 2, 4}}, 0);
  writeColumns(in("columns.t4h"));
  writeParts(in("parts.t4h"));
  writeMesh(in("misoriented.t4h"), {{0, 1, 2, 3}, {0, 1, 2, 4}}, 0);
  // On a grid the mesh may end on the walls of the domain only; this one ends inside.
  writeMesh(in("open.t4h"), {{0, 1, 2, 3}, {1, 0, 2, 4}}, hypermesh::kOnGrid);
  writeMesh(in("empty.t4h"), {}, hypermesh::kOnGrid);
  damagePage(in("mesh.t4h"), in("damaged.t4h"));
  std::vector<char> cut = bytesOf(in("mesh.t4h"));
  cut.resize(cut.size() - 40);
  writeBytes(in("cut.t4h"), cut);
  writeBytes(in("text.txt"), {'h', 'e', 'l', 'l', 'o', '\n'});
  return 0;
}
