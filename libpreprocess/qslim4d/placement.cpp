#include "libpreprocess/qslim4d/placement.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tet4d::qslim4d {
namespace {

// Everything is relative to u.
class Place {
 public:
  Place(const Quadric& q, const Vec4f& u, const Vec4f& v, const Fixed& fixed, const Space& space)
      : q_(q), u_(u), end_(difference(v, u)), fixed_(fixed), space_(space) {
    const glm::dvec4 lengths = space.toLengths(end_);
    length2_ = glm::dot(lengths, lengths);
    const double pull = kPull * q.weight;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) pull_[i][j] = pull * space.square[i][j];
    }
    pull_[3][3] = pull * space.speed * space.speed;
  }

  // The minimum with the coordinates of `mask` as they are in `at`; nothing if the system is singular or the place lies
  // too far off.
  std::optional<glm::dvec4> minimum(unsigned mask, glm::dvec4 at) const;
  double costAt(const glm::dvec4& at) const { return q_.value(at); }
  double tieBreak() const { return kTieBreak * q_.weight * length2_; }
  bool isNear(const glm::dvec4& at) const {
    const glm::dvec4 from_middle = space_.toLengths(at - 0.5 * end_);
    return glm::dot(from_middle, from_middle) <= kFarthest2 * length2_;
  }
  // The pull towards the middle: its matrix over space and time.
  double pullAt(int i, int j) const { return pull_[i][j]; }
  // As a vertex of f32, fixed coordinates exact.
  Vec4f vertexAt(const glm::dvec4& at) const {
    std::array<float, 4> p{static_cast<float>(u_.x + at.x), static_cast<float>(u_.y + at.y),
                           static_cast<float>(u_.z + at.z), static_cast<float>(u_.t + at.w)};
    for (std::size_t c = 0; c < 4; ++c)
      if ((fixed_.mask >> c & 1u) != 0) p[c] = fixed_.value[c];
    return {p[0], p[1], p[2], p[3]};
  }
  glm::dvec4 withFixed(glm::dvec4 at) const {
    const std::array<float, 4> u{u_.x, u_.y, u_.z, u_.t};
    for (int c = 0; c < 4; ++c) {
      const auto i = static_cast<std::size_t>(c);
      if ((fixed_.mask >> i & 1u) != 0) at[c] = double{fixed_.value[i]} - double{u[i]};
    }
    return at;
  }
  const glm::dvec4& end() const { return end_; }

 private:
  const Quadric& q_;
  const Vec4f& u_;
  glm::dvec4 end_;
  const Fixed& fixed_;
  const Space& space_;
  double length2_ = 0;  // of the edge, squared
  double pull_[4][4] = {};
};

// (A + P) x = -b + P m on the free coordinates, by Gaussian elimination with pivots on the diagonal: the matrix is
// positive definite, for the pull is.
std::optional<glm::dvec4> Place::minimum(unsigned mask, glm::dvec4 at) const {
  std::array<int, 4> free{};
  int n = 0;
  for (int c = 0; c < 4; ++c)
    if ((mask >> c & 1u) == 0) free[static_cast<std::size_t>(n++)] = c;
  double m[4][5];
  for (int i = 0; i < n; ++i) {
    const int row = free[static_cast<std::size_t>(i)];
    double right = -q_.b[row];
    for (int c = 0; c < 4; ++c) {
      right += pull_[row][c] * 0.5 * end_[c];
      if ((mask >> c & 1u) != 0) right -= (q_.at(row, c) + pull_[row][c]) * at[c];
    }
    for (int j = 0; j < n; ++j) {
      const int column = free[static_cast<std::size_t>(j)];
      m[i][j] = q_.at(row, column) + pull_[row][column];
    }
    m[i][n] = right;
  }
  for (int k = 0; k < n; ++k) {
    if (!(m[k][k] > 0)) return std::nullopt;
    for (int i = k + 1; i < n; ++i) {
      const double factor = m[i][k] / m[k][k];
      for (int j = k; j <= n; ++j) m[i][j] -= factor * m[k][j];
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    double sum = m[k][n];
    for (int j = k + 1; j < n; ++j) sum -= m[k][j] * at[free[static_cast<std::size_t>(j)]];
    at[free[static_cast<std::size_t>(k)]] = sum / m[k][k];
  }
  for (int c = 0; c < 4; ++c)
    if (!std::isfinite(at[c])) return std::nullopt;
  if (!isNear(at)) return std::nullopt;
  return at;
}

// The same minimum where no coordinate of space is fixed: the place over time t is p - t q, for every t, so one
// factorisation serves all times and the free minimum. A 3x3 LDL^T.
class Track {
 public:
  Track(const Quadric& quadric, const Place& place) : place_(place) {
    const double xx = quadric.xx + place.pullAt(0, 0), xy = quadric.xy + place.pullAt(0, 1),
                 xz = quadric.xz + place.pullAt(0, 2), yy = quadric.yy + place.pullAt(1, 1),
                 yz = quadric.yz + place.pullAt(1, 2), zz = quadric.zz + place.pullAt(2, 2);
    const double ix = 1 / xx, lyx = xy * ix, lzx = xz * ix, dy = yy - lyx * xy;
    const double iy = 1 / dy, rest = yz - lzx * xy, lzy = rest * iy;
    const double dz = zz - lzx * xz - lzy * rest, iz = 1 / dz;
    ok_ = xx > 0 && dy > 0 && dz > 0;
    const auto solve = [&](const glm::dvec3& right) {
      const double y = right.y - lyx * right.x, z = (right.z - lzx * right.x - lzy * y) * iz;
      const double solved_y = y * iy - lzy * z;
      return glm::dvec3(right.x * ix - lyx * solved_y - lzx * z, solved_y, z);
    };
    const glm::dvec4 middle = 0.5 * place.end();
    glm::dvec3 right(0);
    for (int i = 0; i < 3; ++i)
      right[i] =
          -quadric.b[i] + place.pullAt(i, 0) * middle.x + place.pullAt(i, 1) * middle.y + place.pullAt(i, 2) * middle.z;
    const glm::dvec3 column(quadric.xt, quadric.yt, quadric.zt);
    p_ = solve(right), q_ = solve(column);
    slope_ = quadric.tt + place.pullAt(3, 3) - glm::dot(column, q_);
    right_ = -quadric.b.w + place.pullAt(3, 3) * middle.w - glm::dot(column, p_);
  }

  std::optional<glm::dvec4> at(double t) const {
    const glm::dvec4 place(p_ - t * q_, t);
    const bool usable = ok_ && std::isfinite(place.x + place.y + place.z + place.w) && place_.isNear(place);
    return usable ? std::optional(place) : std::nullopt;
  }
  std::optional<glm::dvec4> minimum() const { return slope_ > 0 ? at(right_ / slope_) : std::nullopt; }

 private:
  const Place& place_;
  bool ok_ = false;
  glm::dvec3 p_{0}, q_{0};
  double slope_ = 0, right_ = 0;  // of the 1x1 system that is left for time
};

struct Best {
  glm::dvec4 at{0};
  double cost = 0;
  bool found = false;
  void offer(const glm::dvec4& place, double place_cost) {
    if (found && place_cost >= cost) return;
    at = place, cost = place_cost, found = true;
  }
};

// Times at which a place counts as aligned: the ends', and a frame's between them.
struct AlignedTimes {
  std::array<double, 3> t{};
  std::size_t count = 0;
};

AlignedTimes alignedTimes(const Vec4f& u, const Vec4f& v, bool frames) {
  AlignedTimes times{{0.0, double{v.t} - double{u.t}, 0.0}, u.t == v.t ? std::size_t{1} : std::size_t{2}};
  const double frame = std::nearbyint(0.5 * (double{u.t} + double{v.t}));
  if (frames && frame > std::min(u.t, v.t) && frame < std::max(u.t, v.t)) times.t[times.count++] = frame - double{u.t};
  return times;
}

}  // namespace

Placement placeVertex(const Quadric& q, const Vec4f& u, const Vec4f& v, const Fixed& fixed, double align, bool frames,
                      const Space& space) {
  constexpr unsigned kTime = 1u << 3;
  const Place place(q, u, v, fixed, space);
  Best aligned, any;
  for (const glm::dvec4& end : {glm::dvec4(0), place.end()}) {
    const glm::dvec4 at = place.withFixed(end);
    // An end that a wall moves away from its own place need not be one of the aligned ones.
    aligned.offer(at, place.costAt(at));
  }
  const bool time_is_fixed = (fixed.mask & kTime) != 0;
  const bool is_flat = time_is_fixed || u.t == v.t;
  const auto offer = [&](Best& best, const std::optional<glm::dvec4>& at) {
    if (at) best.offer(*at, place.costAt(*at));
  };
  const AlignedTimes times = alignedTimes(u, v, frames);
  const std::size_t count = time_is_fixed ? 1 : times.count;
  const auto startAt = [&](double t) { return place.withFixed({0, 0, 0, t}); };
  if ((fixed.mask & ~kTime) == 0) {
    const Track track(q, place);
    for (std::size_t i = 0; i < count; ++i) offer(aligned, track.at(startAt(times.t[i]).w));
    if (!is_flat) offer(any, track.minimum());
  } else {
    for (std::size_t i = 0; i < count; ++i) offer(aligned, place.minimum(fixed.mask | kTime, startAt(times.t[i])));
    if (!is_flat) offer(any, place.minimum(fixed.mask, startAt(0)));
  }
  const bool is_aligned = !any.found || aligned.cost <= (1 + align) * any.cost + place.tieBreak();
  const Best& best = is_aligned ? aligned : any;
  const double error = q.weight > 0 ? std::sqrt(best.cost / q.weight) : 0;
  return {place.vertexAt(best.at), best.cost + place.tieBreak(), error, is_aligned};
}

}  // namespace tet4d::qslim4d
