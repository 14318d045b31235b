#include "libpreprocess/qslim4d/collapse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace tet4d::qslim4d {
namespace {

constexpr double kLeastTurn = 0.2588190451025207;  // cosine of 75 degrees
// A tetrahedron whose 3-volume is below this share of its longest edge's cube has none: f32 coordinates say no more.
constexpr double kLeastVolume = 1e-9;

// Flags of a vertex while links are compared.
enum Mark : std::uint32_t { kOfU = 1, kOfBoth = 2 };

bool has(const hypermesh::Tet& tet, std::uint32_t v) {
  return tet[0] == v || tet[1] == v || tet[2] == v || tet[3] == v;
}

std::uint64_t edgeOf(std::uint32_t a, std::uint32_t b) {
  return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
}

template <class T>
bool holds(const std::vector<T>& few, const T& item) {
  return std::find(few.begin(), few.end(), item) != few.end();
}

template <class T>
bool haveCommon(const std::vector<T>& few, const std::vector<T>& others) {
  return std::any_of(few.begin(), few.end(), [&](const T& item) { return holds(others, item); });
}

// The items that an ascending list holds exactly once, in place.
void keepSingles(std::vector<std::uint64_t>& items) {
  std::sort(items.begin(), items.end());
  std::size_t kept = 0;
  for (std::size_t i = 0, end = 0; i < items.size(); i = end) {
    while (end < items.size() && items[end] == items[i]) ++end;
    if (end - i == 1) items[kept++] = items[i];
  }
  items.resize(kept);
}

}  // namespace

bool Collapser::evaluate(std::uint32_t u, std::uint32_t v, Placement& placement) const {
  if (((mesh_->is_boundary[u] | mesh_->is_boundary[v]) & kLocked) != 0) return false;
  const Walls wu = mesh_->walls[u], wv = mesh_->walls[v], both = wu | wv;
  if (both != wu && both != wv) return false;
  const Vec4f& held = mesh_->positions[both == wu ? u : v];
  Fixed fixed{0, {held.x, held.y, held.z, held.t}};
  for (unsigned c = 0; c < 4; ++c)
    if ((both >> (2 * c) & 3u) != 0) fixed.mask |= 1u << c;
  Quadric q = mesh_->quadrics[v].about(difference(mesh_->positions[u], mesh_->positions[v]));
  q.add(mesh_->quadrics[u]);
  placement =
      placeVertex(q, mesh_->positions[u], mesh_->positions[v], fixed, rules_.align, rules_.frames, mesh_->space);
  return true;
}

std::uint32_t Collapser::starSize(std::uint32_t v) const {
  std::uint32_t size = 0;
  mesh_->forEachTet(v, [&](std::uint32_t, std::uint32_t) { ++size; });
  return size;
}

// Edges and faces of the link of v, apart from its tetrahedra with `other`, all of whose vertices lie in Lk(uv).
void Collapser::sharedPieces(std::uint32_t v, std::uint32_t other, std::vector<Edge>& edges, std::vector<Face>& faces) {
  edges.clear(), faces.clear();
  mesh_->forEachTet(v, [&](std::uint32_t t, std::uint32_t corner) {
    const hypermesh::Tet& tet = mesh_->tets[t];
    if (has(tet, other)) return;
    Face shared{};
    std::size_t n = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
      if (i != corner && (marks_[tet[i]] & kOfBoth) != 0) shared[n++] = tet[i];
    if (n < 2) return;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) edges.push_back(edgeOf(shared[i], shared[j]));
    if (n < 3) return;
    std::sort(shared.begin(), shared.end());
    faces.push_back(shared);
  });
}

// Lk(u) and Lk(v) may share what is in Lk(uv) and nothing else. Vertices first; edges and faces in both links then have
// their corners among the few of Lk(uv).
bool Collapser::linksAllow(std::uint32_t u, std::uint32_t v) {
  link_edges_.clear();
  mesh_->forEachTet(v, [&](std::uint32_t t, std::uint32_t) {
    const hypermesh::Tet& tet = mesh_->tets[t];
    if (!has(tet, u)) return;
    std::array<std::uint32_t, 4> rest{};
    std::size_t n = 0;
    for (const std::uint32_t w : tet)
      if (w != u && w != v) rest[n++] = w;
    link_edges_.push_back(edgeOf(rest[0], rest[1]));
    marks_[rest[0]] |= kOfBoth;
    marks_[rest[1]] |= kOfBoth;
  });
  if (link_edges_.empty()) return false;
  mesh_->forEachTet(u, [&](std::uint32_t t, std::uint32_t) {
    if (has(mesh_->tets[t], v)) return;
    for (const std::uint32_t w : mesh_->tets[t]) marks_[w] |= kOfU;
  });
  bool allowed = true;
  mesh_->forEachTet(v, [&](std::uint32_t t, std::uint32_t) {
    if (!allowed || has(mesh_->tets[t], u)) return;
    for (const std::uint32_t w : mesh_->tets[t])
      if (w != v && (marks_[w] & (kOfU | kOfBoth)) == kOfU) allowed = false;
  });
  if (!allowed) return false;
  sharedPieces(u, v, edges_u_, faces_u_);
  sharedPieces(v, u, edges_v_, faces_v_);
  if (haveCommon(faces_u_, faces_v_)) return false;
  return std::none_of(edges_u_.begin(), edges_u_.end(),
                      [&](Edge edge) { return holds(edges_v_, edge) && !holds(link_edges_, edge); });
}

// Edges of the link of v in one of its triangles only: the boundary as seen from v.
void Collapser::readBorder(std::uint32_t v, std::vector<Edge>& border) const {
  border.clear();
  mesh_->forEachTet(v, [&](std::uint32_t t, std::uint32_t corner) {
    std::array<std::uint32_t, 3> opposite{};
    std::size_t n = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
      if (i != corner) opposite[n++] = mesh_->tets[t][i];
    border.insert(border.end(), {edgeOf(opposite[0], opposite[1]), edgeOf(opposite[0], opposite[2]),
                                 edgeOf(opposite[1], opposite[2])});
  });
  keepSingles(border);
}

// The same with the boundary coned to one more vertex: its cone over a face of the boundary is a tetrahedron.
bool Collapser::bordersAllow(std::uint32_t u, std::uint32_t v) {
  if ((mesh_->is_boundary[u] & mesh_->is_boundary[v] & kOnBoundary) == 0) return true;
  readBorder(u, border_u_);
  readBorder(v, border_v_);
  const auto touches = [](const std::vector<Edge>& border, std::uint32_t w) {
    return std::any_of(border.begin(), border.end(), [&](Edge edge) {
      return static_cast<std::uint32_t>(edge >> 32) == w || static_cast<std::uint32_t>(edge) == w;
    });
  };
  if (!touches(border_u_, v)) return false;  // the edge runs through the inside from boundary to boundary
  for (const Edge edge : border_u_) {
    for (const std::uint32_t w : {static_cast<std::uint32_t>(edge >> 32), static_cast<std::uint32_t>(edge)}) {
      if (w != v && touches(border_v_, w) && !holds(border_u_, edgeOf(v, w))) return false;
    }
  }
  // Edges with u or v in them are no edges of both links.
  return !haveCommon(border_u_, border_v_);
}

// The tetrahedra at v without `other`, with v moved to `at`.
Verdict Collapser::judgeStar(std::uint32_t v, std::uint32_t other, const Vec4f& at) const {
  Verdict verdict = Verdict::kAllowed;
  mesh_->forEachTet(v, [&](std::uint32_t t, std::uint32_t corner) {
    const hypermesh::Tet& tet = mesh_->tets[t];
    if (verdict != Verdict::kAllowed || tet[0] == other || tet[1] == other || tet[2] == other || tet[3] == other)
      return;
    std::array<Vec4f, 4> p{};
    for (std::size_t i = 0; i < 4; ++i) p[i] = mesh_->positions[tet[i]];
    // From the corner that stays first, so that both normals are formed from the same differences but one.
    const std::size_t base = corner == 0 ? 1 : 0;
    const auto normalOf = [&] {
      std::array<glm::dvec4, 3> edges{};
      std::size_t n = 0;
      for (std::size_t i = 0; i < 4; ++i)
        if (i != base) edges[n++] = difference(p[i], p[base]);
      return cross4(edges[0], edges[1], edges[2]);
    };
    const glm::dvec4 before = normalOf();
    p[corner] = at;
    const glm::dvec4 after = normalOf();
    if (p[0].t == p[1].t && p[1].t == p[2].t && p[2].t == p[3].t) {
      verdict = Verdict::kFlatTime;
      return;
    }
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, mesh_->space.extent(difference(p[i], p[j])));
    const glm::dvec3 was = mesh_->space.spatialNormal(before), is = mesh_->space.spatialNormal(after);
    const double scaled_is = mesh_->space.speed * glm::length(is);
    const double volume = std::sqrt(scaled_is * scaled_is + after.w * after.w);
    if (!(volume > kLeastVolume * longest * longest * longest)) {
      verdict = Verdict::kFlip;
      return;
    }
    // Spatial normals, for they are what a slice shows; where the surface jumps there is none, and the whole normal
    // counts.
    const double lengths = glm::length(was) * glm::length(is);
    const double slope_before = mesh_->space.speed * glm::length(was);
    if (slope_before > 1e-3 * std::abs(before.w)) {
      if (!(glm::dot(was, is) >= kLeastTurn * lengths) || lengths == 0) verdict = Verdict::kFlip;
    } else {
      const double s = mesh_->space.speed * mesh_->space.speed;
      const double dot = s * glm::dot(was, is) + before.w * after.w;
      const double size = std::sqrt(slope_before * slope_before + before.w * before.w) * volume;
      if (!(dot >= kLeastTurn * size)) verdict = Verdict::kFlip;
    }
  });
  return verdict;
}

// The cheap tests first, and those that refuse most.
Verdict Collapser::judge(std::uint32_t u, std::uint32_t v, const Vec4f& at) {
  const std::uint32_t size_u = starSize(u), size_v = starSize(v);
  std::uint32_t both = 0;
  mesh_->forEachTet(v, [&](std::uint32_t t, std::uint32_t) { both += has(mesh_->tets[t], u) ? 1 : 0; });
  const std::uint32_t left = size_u + size_v - 2 * both;
  if (left > rules_.most_star) return Verdict::kStar;
  if (left == 0) return Verdict::kLinks;  // nothing would be left of the component
  if (const Verdict verdict = judgeStar(u, v, at); verdict != Verdict::kAllowed) return verdict;
  if (const Verdict verdict = judgeStar(v, u, at); verdict != Verdict::kAllowed) return verdict;
  marks_.begin(3 * (std::size_t{size_u} + size_v));
  return linksAllow(u, v) && bordersAllow(u, v) ? Verdict::kAllowed : Verdict::kLinks;
}

std::uint32_t Collapser::collapse(std::uint32_t u, std::uint32_t v, const Vec4f& at) {
  SlimMesh& mesh = *mesh_;
  const Vec4f from_u = mesh.positions[u], from_v = mesh.positions[v];
  std::uint32_t removed = 0;
  // v's list: tetrahedra with u die, in the others u takes v's place. What stays is chained on to u's list.
  std::uint32_t first = kNone, last = kNone;
  for (std::uint32_t c = mesh.head[v], next = kNone; c != kNone; c = next) {
    next = mesh.next[c];
    hypermesh::Tet& tet = mesh.tets[c / 4];
    if (tet[0] == kNone) continue;
    if (has(tet, u)) {
      tet[0] = kNone;
      ++removed;
      continue;
    }
    tet[c % 4] = u;
    (first == kNone ? first : mesh.next[last]) = c;
    last = c;
  }
  if (last != kNone) mesh.next[last] = kNone;
  std::uint32_t tail = kNone;
  std::uint32_t* link = &mesh.head[u];
  for (std::uint32_t c = mesh.head[u]; c != kNone; c = mesh.next[c]) {
    if (!mesh.isLive(c / 4)) continue;
    *link = c;
    link = &mesh.next[c];
    tail = c;
  }
  *link = first;
  mesh.tail[u] = last != kNone ? last : tail;
  mesh.head[v] = mesh.tail[v] = kNone;
  mesh.quadrics[u] = mesh.quadrics[u].about(difference(at, from_u));
  mesh.quadrics[u].add(mesh.quadrics[v].about(difference(at, from_v)));
  mesh.positions[u] = at;
  mesh.walls[u] |= mesh.walls[v];
  mesh.is_boundary[u] |= mesh.is_boundary[v];
  return removed;
}

std::span<const std::uint32_t> Collapser::neighbours(std::uint32_t v) {
  neighbours_.clear();
  marks_.begin(3 * std::size_t{starSize(v)});
  mesh_->forEachTet(v, [&](std::uint32_t tet, std::uint32_t) {
    for (const std::uint32_t w : mesh_->tets[tet]) {
      if (w == v || std::exchange(marks_[w], 1) != 0) continue;
      neighbours_.push_back(w);
    }
  });
  return neighbours_;
}

}  // namespace tet4d::qslim4d
