#include "tests/player/tet_soup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "formats/core/tet_slice.h"

namespace tet4d::test {

Soup soup(unsigned seed, std::size_t tets, int frames) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  Soup made;
  for (std::size_t i = 0; i < tets; ++i) {
    const std::array<double, 3> centre{uniform(0, 10), uniform(0, 10), uniform(0, 10)};
    const auto first = static_cast<std::uint32_t>(made.vertices.size());
    for (int k = 0; k < 4; ++k) {
      double t = uniform(0, frames);
      if (random() % 2 == 0) t = std::round(t);
      made.vertices.push_back({static_cast<float>(centre[0] + uniform(-1, 1)),
                               static_cast<float>(centre[1] + uniform(-1, 1)),
                               static_cast<float>(centre[2] + uniform(-1, 1)), static_cast<float>(t)});
    }
    made.tets.push_back({first, first + 1, first + 2, first + 3});
  }
  return made;
}

std::string writeHypermesh(const std::string& name, const Soup& soup, const std::vector<double>& times) {
  const std::string path = temporaryDirectory() + "/" + name;
  Bounds4f bounds;
  for (const Vec4f& v : soup.vertices) bounds.add(v);
  hypermesh::MeshHeader header{};
  header.domain = bounds;
  header.domain.max.t = static_cast<float>(times.size() - 1);
  header.index_to_world = AffineMap{};
  auto writer = hypermesh::Writer::create(path, header, times, {}, paged::Codec::kRaw, true);
  EXPECT_TRUE(writer.ok());
  EXPECT_TRUE(writer.value().addPage(soup.vertices, {}, soup.tets, bounds).ok());
  EXPECT_TRUE(writer.value().close("{}").ok());
  return path;
}

Page trianglesOf(const Soup& soup) {
  Page page;
  page.vertices = soup.vertices;
  std::vector<std::pair<dyntri::Lifespan, dyntri::Triangle>> triangles;
  for (const hypermesh::Tet& tet : soup.tets) {
    const auto time = [&](std::size_t k) { return soup.vertices[tet[k]].t; };
    const TimeOrder order = orderByTime(time(0), time(1), time(2), time(3));
    for (const DynTriRule& rule : kDynTriRules) {
      const dyntri::Lifespan life{time(order.at[rule.begin]), time(order.at[rule.end])};
      if (!(life.begin < life.end)) continue;
      dyntri::Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& ends = kTetEdges[rule.edges[k]];
        triangle[k] = static_cast<std::uint32_t>(page.edges.size());
        page.edges.push_back({tet[order.at[ends[0]]], tet[order.at[ends[1]]]});
      }
      if (order.odd) std::swap(triangle[1], triangle[2]);
      triangles.emplace_back(life, triangle);
    }
  }
  std::stable_sort(triangles.begin(), triangles.end(),
                   [](const auto& a, const auto& b) { return a.first.begin < b.first.begin; });
  for (const auto& [life, triangle] : triangles) {
    page.lifespans.push_back(life);
    page.triangles.push_back(triangle);
  }
  return page;
}

std::uint64_t trianglesAlive(const Soup& soup, float t, float last_t) {
  std::uint64_t alive = 0;
  for (const hypermesh::Tet& tet : soup.tets) {
    const auto before = std::count_if(tet.begin(), tet.end(), [&](std::uint32_t v) {
      return t == last_t ? soup.vertices[v].t < t : soup.vertices[v].t <= t;
    });
    alive += before == 2 ? 2 : before == 1 || before == 3 ? 1 : 0;
  }
  return alive;
}

}  // namespace tet4d::test
