#include "tests/topology/space_time_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libpreprocess/error.h"

namespace tet4d::testing {
namespace {

using hypermesh::Tet;

// Turns tetrahedra so that N points away from `centre`.
void turnOutward(SpaceTimeMesh& mesh, const std::array<double, 4>& centre) {
  for (Tet& tet : mesh.tets) {
    double m[4][4];
    for (std::size_t r = 0; r < 4; ++r) {
      const Vec4f &a = mesh.vertices[tet[0]], &v = mesh.vertices[tet[r]];
      const std::array<double, 4> p{v.x, v.y, v.z, v.t}, base{a.x, a.y, a.z, a.t};
      for (std::size_t c = 0; c < 4; ++c) m[r][c] = r == 0 ? base[c] - centre[c] : p[c] - base[c];
    }
    double det = 1;
    for (std::size_t i = 0; i < 4; ++i) {
      std::size_t pivot = i;
      for (std::size_t r = i + 1; r < 4; ++r) {
        if (std::abs(m[r][i]) > std::abs(m[pivot][i])) pivot = r;
      }
      if (pivot != i) std::swap(m[i], m[pivot]), det = -det;
      det *= m[i][i];
      for (std::size_t r = i + 1; r < 4; ++r) {
        for (std::size_t c = 3;; --c) {
          m[r][c] -= m[r][i] / m[i][i] * m[i][c];
          if (c == i) break;
        }
      }
    }
    if (det < 0) std::swap(tet[2], tet[3]);
  }
}

}  // namespace

std::vector<Vec3f> cubeCorners() {
  std::vector<Vec3f> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  }
  return corners;
}

Triangles cubeTriangles() {
  return {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
          {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
}

SpaceTimeMesh extrude(const Triangles& triangles, std::size_t frames,
                      const std::function<std::vector<Vec3f>(std::size_t)>& at) {
  SpaceTimeMesh mesh;
  std::uint32_t n = 0;
  for (std::size_t k = 0; k < frames; ++k) {
    const auto places = at(k);
    n = static_cast<std::uint32_t>(places.size());
    for (const Vec3f& p : places) mesh.vertices.push_back({p.x, p.y, p.z, static_cast<float>(k)});
  }
  for (std::size_t k = 0; k + 1 < frames; ++k) {
    const auto low = static_cast<std::uint32_t>(k) * n, high = low + n;
    for (auto v : triangles) {
      bool odd = false;
      for (const auto& [i, j] : {std::pair{0u, 1u}, std::pair{1u, 2u}, std::pair{0u, 1u}}) {
        if (v[j] < v[i]) std::swap(v[i], v[j]), odd = !odd;
      }
      std::array<Tet, 3> prism{{{low + v[0], low + v[1], low + v[2], high + v[2]},
                                {low + v[0], low + v[1], high + v[2], high + v[1]},
                                {low + v[0], high + v[0], high + v[1], high + v[2]}}};
      for (Tet& tet : prism) {
        if (odd) std::swap(tet[2], tet[3]);
        mesh.tets.push_back(tet);
      }
    }
  }
  return mesh;
}

SpaceTimeMesh stillCube(std::size_t frames) {
  return extrude(cubeTriangles(), frames, [](std::size_t) { return cubeCorners(); });
}

SpaceTimeMesh simplexBoundary() {
  SpaceTimeMesh mesh{{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}},
                     {{1, 2, 3, 4}, {0, 2, 3, 4}, {0, 1, 3, 4}, {0, 1, 2, 4}, {0, 1, 2, 3}}};
  turnOutward(mesh, {0.2, 0.2, 0.2, 0.2});
  return mesh;
}

SpaceTimeMesh crossPolytopeBoundary() {
  SpaceTimeMesh mesh{{{1, 0, 0, 1},
                      {-1, 0, 0, 1},
                      {0, 1, 0, 1},
                      {0, -1, 0, 1},
                      {0, 0, 1, 1},
                      {0, 0, -1, 1},
                      {0, 0, 0, 2},
                      {0, 0, 0, 0}},
                     {}};
  for (std::uint32_t i = 0; i < 16; ++i) {
    mesh.tets.push_back({i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2 & 1), 6 + (i >> 3 & 1)});
  }
  turnOutward(mesh, {0, 0, 0, 1});
  return mesh;
}

Bounds4f farDomain(const SpaceTimeMesh& mesh) {
  Bounds4f box;
  for (const Vec4f& v : mesh.vertices) box.add(v);
  box.min.x -= 100, box.min.y -= 100, box.min.z -= 100;
  box.max.x += 100, box.max.y += 100, box.max.z += 100;
  return box;
}

void writeFile(const std::string& path, const SpaceTimeMesh& mesh, const Pages& pages, std::uint32_t flags,
               const Bounds4f& domain) {
  Bounds4f box;
  for (const Vec4f& v : mesh.vertices) box.add(v);
  std::vector<double> times;
  for (std::size_t k = 0; k < 2 || static_cast<float>(k) <= box.max.t; ++k) times.push_back(static_cast<double>(k));
  hypermesh::MeshHeader header{};
  header.index_to_world = AffineMap{};
  header.flags = flags;
  header.domain = domain;
  header.isovalue = 0;
  auto writer = unwrap(hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true));
  std::uint64_t first = 0;
  for (std::size_t p = 0; p < pages.owner_ends.size(); ++p) {
    const std::uint64_t end = pages.owner_ends[p];
    std::vector<Tet> tets;
    std::set<std::uint32_t> foreign;
    for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
      if (pages.page_of_tet[i] != p) continue;
      tets.push_back(mesh.tets[i]);
      for (const std::uint32_t v : mesh.tets[i]) {
        if (v < first || v >= end) foreign.insert(v);
      }
    }
    std::vector<hypermesh::Run> runs;
    for (const std::uint32_t v : foreign) {
      const bool next = !runs.empty() && runs.back().first + runs.back().count == v && v != first && v != end;
      if (next) {
        ++runs.back().count;
      } else {
        runs.push_back({v, 1});
      }
    }
    for (Tet& tet : tets) {
      for (std::uint32_t& v : tet) {
        if (v >= first && v < end) {
          v -= static_cast<std::uint32_t>(first);
        } else {
          v = static_cast<std::uint32_t>(end - first) +
              static_cast<std::uint32_t>(std::distance(foreign.begin(), foreign.find(v)));
        }
      }
    }
    const std::span own(mesh.vertices.data() + first, end - first);
    // The whole box for every page: larger than need be, and in order however the tetrahedra are dealt out.
    unwrap(writer.addPage(own, runs, tets, box));
    first = end;
  }
  unwrap(writer.close("{}"));
}

void writeFile(const std::string& path, const SpaceTimeMesh& mesh, std::uint32_t flags, const Bounds4f& domain) {
  writeFile(path, mesh, {{mesh.vertices.size()}, std::vector<std::size_t>(mesh.tets.size(), 0)}, flags, domain);
}

std::string temporaryFile(const std::string& name) {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string path = ::testing::TempDir() + "tet4d_" + test->test_suite_name() + "_" + test->name() + "_" + name;
  std::replace(path.begin() + static_cast<std::ptrdiff_t>(::testing::TempDir().size()), path.end(), '/', '_');
  return path;
}

}  // namespace tet4d::testing
