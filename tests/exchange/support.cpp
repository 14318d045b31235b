#include "tests/exchange/support.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <sstream>
#include <utility>

namespace tet4d::testing {

Scratch::Scratch() {
  std::string name = (std::filesystem::temp_directory_path() / "tet4d-exchange-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string Scratch::write(const std::string& name, std::string_view content) const {
  std::filesystem::create_directories((folder_ / name).parent_path());
  std::ofstream file(folder_ / name, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  return path(name);
}

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Fault faultOf(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_FALSE(error.fault().what.empty());
    EXPECT_FALSE(error.fault().remedy.empty()) << error.fault().what;
    return error.fault();
  }
  ADD_FAILURE() << "no error was thrown";
  return {};
}

double volumeOf(const SliceMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f &p = mesh.positions[t[0]], &q = mesh.positions[t[1]], &r = mesh.positions[t[2]];
    sum += double{p.x} * (double{q.y} * r.z - double{q.z} * r.y) -
           double{p.y} * (double{q.x} * r.z - double{q.z} * r.x) +
           double{p.z} * (double{q.x} * r.y - double{q.y} * r.x);
  }
  return sum / 6;
}

double areaOf(const SliceMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f &p = mesh.positions[t[0]], &q = mesh.positions[t[1]], &r = mesh.positions[t[2]];
    const double ux = double{q.x} - p.x, uy = double{q.y} - p.y, uz = double{q.z} - p.z;
    const double vx = double{r.x} - p.x, vy = double{r.y} - p.y, vz = double{r.z} - p.z;
    sum += std::hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
  }
  return sum;
}

bool isClosed(const SliceMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = t[c], b = t[(c + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

std::size_t repeatedTriangles(const SliceMesh& mesh) {
  std::set<std::array<std::uint32_t, 3>> seen;
  for (auto triangle : mesh.triangles) {
    std::sort(triangle.begin(), triangle.end());
    seen.insert(triangle);
  }
  return mesh.triangles.size() - seen.size();
}

namespace {

using Row = std::array<double, 4>;

double determinant(std::array<Row, 4> m) {
  double product = 1;
  for (std::size_t k = 0; k < 4; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 4; ++i) {
      if (std::abs(m[i][k]) > std::abs(m[pivot][k])) pivot = i;
    }
    if (m[pivot][k] == 0) return 0;
    if (pivot != k) std::swap(m[pivot], m[k]), product = -product;
    product *= m[k][k];
    for (std::size_t i = k + 1; i < 4; ++i) {
      const double factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j < 4; ++j) m[i][j] -= factor * m[k][j];
    }
  }
  return product;
}

Row difference(const Vec4f& a, const Vec4f& b) {
  return {double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z, double{a.t} - b.t};
}

// Orders a facet so that it is positive for the normal away from `inside`.
hypermesh::Tet outward(hypermesh::Tet tet, const Vec4f& inside, const std::vector<Vec4f>& vertices) {
  const Vec4f& a = vertices[tet[0]];
  const double sign = determinant({difference(a, inside), difference(vertices[tet[1]], a),
                                   difference(vertices[tet[2]], a), difference(vertices[tet[3]], a)});
  if (sign < 0) std::swap(tet[2], tet[3]);
  return tet;
}

}  // namespace

SpaceTime cubesBoundary(std::uint32_t n, const std::vector<bool>& filled) {
  const std::uint32_t side = n + 1;
  const std::array<std::uint32_t, 4> stride{1, side, side * side, side * side * side};
  SpaceTime mesh;
  for (std::uint32_t i = 0; i < side * stride[3]; ++i) {
    mesh.vertices.push_back({static_cast<float>(i % side), static_cast<float>(i / stride[1] % side),
                             static_cast<float>(i / stride[2] % side), static_cast<float>(i / stride[3])});
  }
  std::map<hypermesh::Tet, std::pair<int, hypermesh::Tet>> facets;  // sorted corners → count, outward order
  for (std::uint32_t cell = 0; cell < filled.size(); ++cell) {
    if (!filled[cell]) continue;
    const std::uint32_t corner =
        cell % n + cell / n % n * stride[1] + cell / (n * n) % n * stride[2] + cell / (n * n * n) * stride[3];
    std::array<std::size_t, 4> axes{0, 1, 2, 3};
    do {
      std::array<std::uint32_t, 5> simplex{corner};
      for (std::size_t k = 0; k < 4; ++k) simplex[k + 1] = simplex[k] + stride[axes[k]];
      for (std::size_t left_out = 0; left_out < 5; ++left_out) {
        hypermesh::Tet tet{};
        for (std::size_t k = 0, at = 0; k < 5; ++k) {
          if (k != left_out) tet[at++] = simplex[k];
        }
        auto& [count, oriented] = facets[tet];  // corners ascend already
        ++count;
        oriented = outward(tet, mesh.vertices[simplex[left_out]], mesh.vertices);
      }
    } while (std::next_permutation(axes.begin(), axes.end()));
  }
  for (const auto& [key, facet] : facets) {
    if (facet.first == 1) mesh.tets.push_back(facet.second);
  }
  return mesh;
}

std::vector<bool> randomCells(std::uint32_t n, double odds, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<bool> cells(std::size_t{n} * n * n * n);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<double>(random()) < odds * 4294967296.0;
  return cells;
}

void writeSlabs(const std::string& path, const SpaceTime& mesh, std::uint32_t frames, const AffineMap& map,
                std::span<const double> times, const std::vector<VertexColumn>& columns) {
  hypermesh::MeshHeader header{};
  header.flags = hypermesh::kOnGrid;
  header.index_to_world = map;
  header.isovalue = 0.5;
  for (const Vec4f& vertex : mesh.vertices) header.domain.add(vertex);
  std::vector<hypermesh::Writer::Column> declared;
  for (const VertexColumn& column : columns) declared.push_back({column.name, column.components});
  auto writer = unwrap(hypermesh::Writer::create(path, header, times, declared, paged::Codec::kRaw, true));
  const auto begins = [&](std::uint32_t time) {  // first vertex at or after a time
    const auto it = std::find_if(mesh.vertices.begin(), mesh.vertices.end(),
                                 [&](const Vec4f& v) { return v.t >= static_cast<float>(time); });
    return static_cast<std::uint32_t>(it - mesh.vertices.begin());
  };
  for (std::uint32_t k = 0; k + 1 < frames; ++k) {
    const bool is_last = k + 2 == frames;
    const std::uint32_t first = begins(k), next = is_last ? begins(frames) : begins(k + 1), end = begins(k + 2);
    std::vector<hypermesh::Tet> tets;
    Bounds4f bounds;
    for (const hypermesh::Tet& tet : mesh.tets) {
      float begin = mesh.vertices[tet[0]].t;
      for (const std::uint32_t v : tet) begin = std::min(begin, mesh.vertices[v].t);
      const auto slab = std::min(static_cast<std::uint32_t>(begin), frames - 2);
      if (slab != k) continue;
      hypermesh::Tet local = tet;
      for (std::uint32_t& v : local) bounds.add(mesh.vertices[v]), v -= first;
      tets.push_back(local);
    }
    if (tets.empty()) bounds = {{0, 0, 0, static_cast<float>(k)}, {0, 0, 0, static_cast<float>(k + 1)}};
    bounds.min.t = static_cast<float>(k);
    bounds.max.t = static_cast<float>(k + 1);
    std::vector<hypermesh::Run> runs;
    if (!is_last) runs.push_back({next, end - next});
    std::vector<std::span<const float>> own;
    for (const VertexColumn& column : columns) {
      const std::size_t n = column.components;
      own.push_back(std::span(column.values).subspan(first * n, (next - first) * n));
    }
    unwrap(writer.addPage(std::span(mesh.vertices).subspan(first, next - first), runs, tets, bounds, own));
  }
  unwrap(writer.close("{}"));
}

}  // namespace tet4d::testing
