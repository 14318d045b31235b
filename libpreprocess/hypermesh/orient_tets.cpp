#include "libpreprocess/hypermesh/orient_tets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "libpreprocess/error.h"

namespace tet4d::hypermesh {
namespace {

using Tet = std::array<std::uint32_t, 4>;
using Points = std::span<const std::array<double, 3>>;

// Six times the volume; exactly 0 where the sign is not certain. Coordinates are scaled by a power of two that keeps
// products in range.
double volumeOf(Points points, const Tet& tet, double scale) {
  std::array<std::array<double, 3>, 3> e{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      e[i][c] = points[tet[i + 1]][c] * scale - points[tet[0]][c] * scale;
    }
  }
  const auto term = [&](std::size_t i, std::size_t j, std::size_t k) { return e[0][i] * e[1][j] * e[2][k]; };
  const double sum = term(0, 1, 2) + term(1, 2, 0) + term(2, 0, 1) - term(2, 1, 0) - term(1, 0, 2) - term(0, 2, 1);
  double magnitude = 0;
  for (const auto& [i, j, k] : {std::tuple{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}, {1, 0, 2}, {0, 2, 1}}) {
    magnitude += std::abs(term(static_cast<std::size_t>(i), static_cast<std::size_t>(j), static_cast<std::size_t>(k)));
  }
  const double bound = magnitude * 16 * 0x1p-53;
  return std::abs(sum) > bound ? sum : 0;
}

double scaleOf(Points points) {
  double most = 0;
  for (const auto& p : points) {
    for (const double c : p) most = std::max(most, std::abs(c));
  }
  return most > 0 ? std::ldexp(1.0, -std::ilogb(most)) : 1.0;
}

// A triangle of a tetrahedron: its corners ascending, and which way round the tetrahedron's order passes it.
struct Face {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t tet;  // times two, plus one where it is passed the other way round
};

Face faceOf(const Tet& tet, std::size_t left_out, std::uint32_t number) {
  Face face{};
  for (std::size_t c = 0, at = 0; c < 4; ++c) {
    if (c != left_out) face.corners[at++] = tet[c];
  }
  std::uint32_t odd = left_out % 2;
  auto& v = face.corners;
  const auto order = [&](std::size_t a, std::size_t b) {
    if (v[a] > v[b]) std::swap(v[a], v[b]), odd ^= 1U;
  };
  order(0, 1), order(1, 2), order(0, 1);
  face.tet = number * 2 + odd;
  return face;
}

// Tetrahedra joined over triangles, each knowing whether it is ordered as its root or the other way.
class Parts {
 public:
  explicit Parts(std::size_t count) : parent_(count), other_(count, 0) { std::iota(parent_.begin(), parent_.end(), 0); }
  // The root of a tetrahedron, and whether it is ordered the other way than the root.
  std::pair<std::uint32_t, bool> find(std::uint32_t tet) {
    bool other = false;
    while (parent_[tet] != tet) {
      const std::uint32_t up = parent_[tet];
      other ^= other_[tet] != 0;
      // Half the way is cut: the parent becomes the grandparent.
      if (parent_[up] != up) {
        other_[tet] = static_cast<std::uint8_t>(other_[tet] ^ other_[up]);
        other ^= other_[up] != 0;
        parent_[tet] = parent_[up];
      }
      tet = parent_[tet];
    }
    return {tet, other};
  }
  // Joins two, ordered alike or not; false if they are joined the other way already.
  bool join(std::uint32_t a, std::uint32_t b, bool alike) {
    const auto [root_a, other_a] = find(a);
    const auto [root_b, other_b] = find(b);
    const bool other = (other_a != other_b) == alike;
    if (root_a == root_b) return !other;
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    other_[std::max(root_a, root_b)] = other ? 1 : 0;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> other_;
};

[[noreturn]] void failFace(const std::string& file, const Face& face, const std::string& what) {
  throw Error(FaultCode::kBadInput, file,
              "triangle " + std::to_string(face.corners[0]) + " " + std::to_string(face.corners[1]) + " " +
                  std::to_string(face.corners[2]),
              what, "the mesh must be a solid that does not meet itself; repair it");
}

void joinOverFaces(std::span<const Tet> tets, const std::string& file, Parts& parts) {
  std::vector<Face> faces;
  faces.reserve(tets.size() * 4);
  for (std::uint32_t i = 0; i < tets.size(); ++i) {
    for (std::size_t c = 0; c < 4; ++c) faces.push_back(faceOf(tets[i], c, i));
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.tet < b.tet;
  });
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].corners != faces[i + 1].corners) continue;
    if (i + 2 < faces.size() && faces[i].corners == faces[i + 2].corners) {
      failFace(file, faces[i], "lies in three tetrahedra or more");
    }
    const bool alike = (faces[i].tet & 1U) != (faces[i + 1].tet & 1U);
    if (!parts.join(faces[i].tet / 2, faces[i + 1].tet / 2, alike)) {
      failFace(file, faces[i], "the tetrahedra around it cannot all be ordered one way");
    }
    ++i;
  }
}

}  // namespace

Orientation orientTets(std::span<const std::array<double, 3>> points, std::span<std::array<std::uint32_t, 4>> tets,
                       const std::string& file, outofcore::MemoryBudget& memory) {
  Orientation found;
  const double scale = scaleOf(points);
  for (const Tet& tet : tets) {
    const double volume = volumeOf(points, tet, scale);
    found.negative += volume < 0;
    found.degenerate += volume == 0;
  }
  if (found.degenerate == 0 && (found.negative == 0 || found.negative == tets.size())) {
    if (found.negative == 0) {
      for (Tet& tet : tets) std::swap(tet[2], tet[3]);
    }
    return found;
  }
  if (tets.size() >> 31 != 0) {
    throw Error(FaultCode::kBadInput, file, "", "2^31 tetrahedra or more, not all of one orientation",
                "turn those with negative volume first");
  }
  const auto held = memory.reserve(tets.size() * (4 * sizeof(Face) + 5), "the triangles of a mesh to be oriented");
  Parts parts(tets.size());
  joinOverFaces(tets, file, parts);
  std::vector<double> sums(tets.size(), 0);  // by root, as the root is ordered
  for (std::uint32_t i = 0; i < tets.size(); ++i) {
    const auto [root, other] = parts.find(i);
    sums[root] += volumeOf(points, tets[i], scale) * (other ? -1 : 1);
  }
  for (std::uint32_t i = 0; i < tets.size(); ++i) {
    const auto [root, other] = parts.find(i);
    if ((sums[root] >= 0) != other) std::swap(tets[i][2], tets[i][3]);
    found.inverted += volumeOf(points, tets[i], scale) > 0;
  }
  return found;
}

}  // namespace tet4d::hypermesh
