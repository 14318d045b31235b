// A file of dynamic triangles beside the hypermesh it was made from: values and parts are those of the hypermesh.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>

#include "libpreprocess/dyntri/dynamic_triangles_builder.h"
#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/outofcore/memory_budget.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::dyntri {
namespace {

using hypermesh::Tet;
using Place = std::array<float, 4>;

Place placeOf(const Vec4f& v) { return {v.x, v.y, v.z, v.t}; }

// What a vertex carries: a pressure, and a unit vector.
constexpr std::size_t kPressure = 0, kNormal = 1;
const std::vector<Column> kColumns{{"pressure", 1}, {"normal", 3}};

struct Values {
  float pressure;
  std::array<float, 3> normal;
};

// A hypermesh of three pages: two of part 0, of which the second borrows vertices of the first, and one of part 1.
struct Made {
  std::string path;
  std::map<Place, Values> by_place;  // no two vertices stand at one place
};

class MeshWriter {
 public:
  explicit MeshWriter(const std::string& path) : path_(path), random_(5) {
    hypermesh::MeshHeader header{};
    header.domain = {{0, 0, 0, 0}, {1, 1, 1, 2}};
    header.index_to_world = AffineMap{};
    const std::array<double, 3> times{0, 1, 2};
    const std::array<double, 2> isovalues{0.25, 0.75};
    writer_.emplace(
        unwrap(hypermesh::Writer::create(path, header, times, kColumns, paged::Codec::kRaw, true, isovalues)));
  }
  // `own` vertices in [begin, begin + 1], and tetrahedra among them and the first page's first `borrowed`.
  void addPage(std::size_t own, std::size_t borrowed, float begin, std::uint64_t part) {
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Vec4f> vertices;
    std::vector<float> pressures, normals;
    for (std::size_t i = 0; i < own; ++i) {
      vertices.push_back({unit(random_), unit(random_), unit(random_), begin + unit(random_)});
      const Values values{i == 3 ? std::nanf("") : unit(random_), {unit(random_), -unit(random_), unit(random_)}};
      pressures.push_back(values.pressure);
      normals.insert(normals.end(), values.normal.begin(), values.normal.end());
      made_.by_place[placeOf(vertices.back())] = values;
    }
    std::vector<hypermesh::Run> runs;
    if (borrowed != 0) runs.push_back({0, borrowed});
    Bounds4f bounds;
    for (const Vec4f& v : vertices) bounds.add(v);
    bounds.add(Vec4f{0, 0, 0, 0});
    bounds.add(Vec4f{1, 1, 1, 2});
    std::uniform_int_distribution<std::uint32_t> pick(0, static_cast<std::uint32_t>(own + borrowed - 1));
    std::vector<Tet> tets;
    while (tets.size() < 3 * own) {
      const Tet tet{pick(random_), pick(random_), pick(random_), pick(random_)};
      const auto& [a, b, c, d] = tet;
      if (a != b && a != c && a != d && b != c && b != d && c != d) tets.push_back(tet);
    }
    const std::array<std::span<const float>, 2> columns{pressures, normals};
    unwrap(writer_->addPage(vertices, runs, tets, bounds, columns, part));
  }
  Made close() {
    unwrap(writer_->close("{}"));
    made_.path = path_;
    return made_;
  }

 private:
  std::string path_;
  std::mt19937 random_;
  std::optional<hypermesh::Writer> writer_;
  Made made_;
};

std::string inFolder(const std::string& name) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("tet4d_dyntri-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return (folder / name).string();
}

Made makeMesh(const std::string& name) {
  MeshWriter writer(inFolder(name));
  writer.addPage(40, 0, 0, 0);
  writer.addPage(30, 25, 0.5F, 0);
  writer.addPage(20, 0, 1, 1);
  return writer.close();
}

// Builds with the hypermesh's columns `chosen`, in this order, on two threads.
File buildFile(const Made& made, const std::string& name, const std::vector<std::size_t>& chosen) {
  const hypermesh::File mesh = unwrap(hypermesh::File::open(made.path));
  Header header{};
  header.index_to_world = mesh.header().index_to_world;
  header.last_time = 2;
  std::vector<Column> columns;
  for (const std::size_t c : chosen) columns.push_back(kColumns[c]);
  const std::array<double, 2> isovalues{0.25, 0.75};
  const std::string path = inFolder(name);
  Writer writer = unwrap(Writer::create(path, header, mesh.times(), paged::Codec::kRaw, true, columns, isovalues));
  outofcore::ThreadExecutor executor(2);
  outofcore::MemoryBudget memory;
  outofcore::Progress progress;
  buildDynamicTriangles(mesh, {kDefaultBands, chosen}, writer, executor, memory, progress);
  unwrap(writer.close("{}"));
  File file = unwrap(File::open(path));
  unwrap(file.verify());
  return file;
}

std::vector<float> rowsOf(const File& file, std::size_t column, std::size_t page, std::size_t components) {
  const auto bytes = unwrap(file.loadColumn(column, page));
  std::vector<float> rows(file.geometryEntry(page).counts[0] * components);
  std::memcpy(rows.data(), bytes.bytes().data(), rows.size() * sizeof(float));
  return rows;
}

bool sameBits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

TEST(CarriedColumns, EveryVertexHasTheValuesOfTheHypermesh) {
  const Made made = makeMesh("columns.t4h");
  const File file = buildFile(made, "columns.t4d", {kNormal, kPressure});  // their order is the caller's
  ASSERT_EQ(file.columns().size(), 2U);
  EXPECT_STREQ(file.columns()[0].name, "normal");
  EXPECT_EQ(file.columns()[0].components, 3U);
  EXPECT_STREQ(file.columns()[1].name, "pressure");
  ASSERT_EQ(file.geometryPages(), 3U);
  std::size_t unknown = 0;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const auto bytes = unwrap(file.loadGeometry(k));
    const PageView page = unwrap(validatePage(bytes.bytes(), file.geometryEntry(k), "columns.t4d", file.tablePage(k)));
    ASSERT_FALSE(page.triangles.empty());
    const std::vector<float> normals = rowsOf(file, 0, k, 3), pressures = rowsOf(file, 1, k, 1);
    for (std::size_t v = 0; v < page.vertices.size(); ++v) {
      const auto found = made.by_place.find(placeOf(page.vertices[v]));
      ASSERT_NE(found, made.by_place.end()) << "page " << k << ", vertex " << v;
      EXPECT_TRUE(sameBits(pressures[v], found->second.pressure)) << "page " << k << ", vertex " << v;
      for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(normals[3 * v + c], found->second.normal[c]) << "page " << k;
      unknown += std::isnan(pressures[v]) ? 1U : 0U;
    }
  }
  EXPECT_GT(unknown, 0U) << "an unknown value stays unknown";
}

TEST(CarriedColumns, PagesKeepTheirParts) {
  const Made made = makeMesh("parts.t4h");
  const File file = buildFile(made, "parts.t4d", {});
  EXPECT_TRUE(file.columns().empty());
  ASSERT_EQ(file.parts().size(), 2U);
  EXPECT_EQ(file.parts()[0].isovalue, 0.25);
  EXPECT_EQ(file.parts()[1].isovalue, 0.75);
  const std::array<std::uint64_t, 3> expected{0, 0, 1};
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const auto bytes = unwrap(file.loadGeometry(k));
    EXPECT_EQ(unwrap(validatePage(bytes.bytes(), file.geometryEntry(k), "parts.t4d", k)).part, expected[k]) << k;
  }
}

}  // namespace
}  // namespace tet4d::dyntri
