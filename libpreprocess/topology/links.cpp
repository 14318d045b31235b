#include "libpreprocess/topology/links.h"

#include <algorithm>
#include <numeric>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/link_judge.h"

namespace tet4d::topology {
namespace {

using hypermesh::Tet;

// The tetrahedra at each vertex, as one list with where each vertex's part ends.
struct Stars {
  std::vector<std::uint64_t> ends;
  std::vector<std::uint32_t> tets;
};

Stars starsOf(std::span<const Tet> tets, std::size_t vertices, LinkJudge& judge) {
  Stars stars{std::vector<std::uint64_t>(vertices + 1), {}};
  std::vector<bool> degenerate(tets.size());
  for (std::size_t i = 0; i < tets.size(); ++i) {
    Tet sorted = tets[i];
    std::sort(sorted.begin(), sorted.end());
    if (sorted.back() >= vertices) {
      throw Error(FaultCode::kBadInput, "", "tetrahedron " + std::to_string(i),
                  "names vertex " + std::to_string(sorted.back()) + ", but there are " + std::to_string(vertices));
    }
    degenerate[i] = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
    if (degenerate[i]) {
      judge.degenerate(i);
      continue;
    }
    for (const std::uint32_t v : tets[i]) ++stars.ends[v + 1];
  }
  std::partial_sum(stars.ends.begin(), stars.ends.end(), stars.ends.begin());
  stars.tets.resize(stars.ends.back());
  // ends[v] is where part v begins; filling moves it to where the part ends.
  for (std::size_t i = 0; i < tets.size(); ++i) {
    if (degenerate[i]) continue;
    for (const std::uint32_t v : tets[i]) stars.tets[stars.ends[v]++] = static_cast<std::uint32_t>(i);
  }
  stars.ends.pop_back();
  return stars;
}

// may_bound(v): whether vertex v may lie on the boundary.
template <class MayBound>
LinkCheck check(std::span<const Tet> tets, std::size_t vertices, MayBound may_bound) {
  LinkJudge judge;
  const Stars stars = starsOf(tets, vertices, judge);
  std::vector<LinkTriangle> link;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const std::uint64_t begin = v == 0 ? 0 : stars.ends[v - 1], end = stars.ends[v];
    if (begin == end) continue;
    link.clear();
    for (std::uint64_t i = begin; i < end; ++i) {
      LinkTriangle opposite{};
      std::size_t c = 0;
      for (const std::uint32_t w : tets[stars.tets[i]]) {
        if (w != v) opposite[c++] = w;
      }
      link.push_back(opposite);
    }
    judge.judge(v, link, may_bound(v));
  }
  return judge.result(vertices);
}

}  // namespace

LinkCheck checkLinks(std::span<const Tet> tets, std::uint64_t vertices, bool boundary_allowed) {
  return check(tets, vertices, [=](std::uint32_t) { return boundary_allowed; });
}

LinkCheck checkLinks(std::span<const Tet> tets, std::span<const std::uint8_t> may_bound) {
  return check(tets, may_bound.size(), [=](std::uint32_t v) { return may_bound[v] != 0; });
}

}  // namespace tet4d::topology
