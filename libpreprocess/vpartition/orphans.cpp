#include "libpreprocess/vpartition/orphans.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace tet4d::vpartition {
namespace {

// Sets of tetrahedra; a set is named by its least member.
class Sets {
 public:
  explicit Sets(std::size_t count) : up_(count) { std::iota(up_.begin(), up_.end(), 0U); }
  std::uint32_t of(std::uint32_t t) {
    while (up_[t] != t) t = up_[t] = up_[up_[t]];
    return t;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = of(a), b = of(b);
    if (a != b) up_[std::max(a, b)] = std::min(a, b);
  }
  // The name of each member's set.
  std::vector<std::uint32_t> all() {
    for (std::uint32_t t = 0; t < up_.size(); ++t) up_[t] = of(t);
    return std::move(up_);
  }

 private:
  std::vector<std::uint32_t> up_;
};

// The tetrahedra at each vertex.
class Stars {
 public:
  Stars(std::span<const hypermesh::Tet> tets, std::size_t vertices) : begin_(vertices + 1), tets_(4 * tets.size()) {
    for (const hypermesh::Tet& tet : tets)
      for (const std::uint32_t v : tet) ++begin_[v + std::size_t{1}];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t t = 0; t < tets.size(); ++t)
      for (const std::uint32_t v : tets[t]) tets_[next[v]++] = t;
  }
  std::size_t size() const { return begin_.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t v) const {
    return {tets_.data() + begin_[v], static_cast<std::size_t>(begin_[v + 1] - begin_[v])};
  }

 private:
  std::vector<std::uint64_t> begin_;
  std::vector<std::uint32_t> tets_;
};

// Pieces: tetrahedra of one owner that hang together by vertices.
Sets piecesOf(const Stars& stars, std::span<const std::uint32_t> owners) {
  Sets pieces(owners.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> seen;  // owners at a vertex, and the first tetrahedron of each
  for (std::size_t v = 0; v < stars.size(); ++v) {
    seen.clear();
    for (const std::uint32_t t : stars[v]) {
      const auto known = std::find_if(seen.begin(), seen.end(), [&](const auto& s) { return s.first == owners[t]; });
      if (known == seen.end()) {
        seen.emplace_back(owners[t], t);
      } else {
        pieces.join(known->second, t);
      }
    }
  }
  return pieces;
}

Sets partsOf(const Stars& stars, std::size_t tets) {
  Sets parts(tets);
  for (std::size_t v = 0; v < stars.size(); ++v)
    for (const std::uint32_t t : stars[v]) parts.join(stars[v].front(), t);
  return parts;
}

// One round; returns how many pieces went.
std::uint64_t mergeRound(std::span<const hypermesh::Tet> tets, const Stars& stars,
                         const std::vector<std::uint32_t>& parts, std::span<std::uint32_t> owners) {
  const std::vector<std::uint32_t> pieces = piecesOf(stars, owners).all();
  std::vector<std::uint32_t> sizes(tets.size());  // by piece
  for (const std::uint32_t piece : pieces) ++sizes[piece];
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> largest;  // piece, by part and owner
  std::size_t count = 0;
  for (std::uint32_t piece = 0; piece < sizes.size(); ++piece) {
    if (sizes[piece] == 0) continue;
    ++count;
    const auto [at, is_new] = largest.try_emplace({parts[piece], owners[piece]}, piece);
    if (!is_new && sizes[piece] > sizes[at->second]) at->second = piece;
  }
  if (largest.size() == count) return 0;
  std::vector<bool> kept(tets.size());  // by piece
  for (const auto& [key, piece] : largest) kept[piece] = true;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint64_t>> contacts;  // by orphan, by owner beside it
  for (std::uint32_t t = 0; t < tets.size(); ++t) {
    if (kept[pieces[t]]) continue;
    auto& contact = contacts[pieces[t]];
    for (const std::uint32_t v : tets[t])
      for (const std::uint32_t other : stars[v])
        if (kept[pieces[other]]) ++contact[owners[other]];
  }
  std::map<std::uint32_t, std::uint32_t> adopters;  // by orphan
  for (const auto& [orphan, contact] : contacts) {
    const auto most = std::max_element(contact.begin(), contact.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second < b.second : a.first > b.first;
    });
    if (most != contact.end()) adopters[orphan] = most->first;  // one among orphans waits for the next round
  }
  for (std::uint32_t t = 0; t < tets.size(); ++t)
    if (const auto at = adopters.find(pieces[t]); at != adopters.end()) owners[t] = at->second;
  return adopters.size();
}

}  // namespace

std::uint64_t mergeOrphans(std::span<const hypermesh::Tet> tets, std::size_t vertices,
                           std::span<std::uint32_t> owners) {
  if (tets.empty() || std::all_of(owners.begin(), owners.end(), [&](auto o) { return o == owners[0]; })) return 0;
  const Stars stars(tets, vertices);
  const std::vector<std::uint32_t> parts = partsOf(stars, tets.size()).all();
  std::uint64_t merged = 0;
  // Every part has a kept piece, so while there are orphans one of them touches a kept one: each round has fewer
  // pieces.
  while (const std::uint64_t round = mergeRound(tets, stars, parts, owners)) merged += round;
  return merged;
}

}  // namespace tet4d::vpartition
