#include "libpreprocess/qslim4d/placement_pair.h"

#include <cmath>
#include <cstdint>

namespace tet4d::qslim4d {
namespace {

using Pair = double __attribute__((vector_size(16)));
using Mask = std::int64_t __attribute__((vector_size(16)));

Pair both(double value) { return Pair{value, value}; }
Pair choose(Mask mask, Pair yes, Pair no) {
  return reinterpret_cast<Pair>((mask & reinterpret_cast<Mask>(yes)) | (~mask & reinterpret_cast<Mask>(no)));
}
Mask isFinite(Pair value) { return value - value == both(0); }

struct Pair3 {
  Pair x, y, z;
};
struct Pair4 {
  Pair x, y, z, w;
};

Pair dot(const Pair3& a, const Pair3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Pair dot(const Pair4& a, const Pair4& b) { return (a.x * b.x + a.y * b.y) + (a.z * b.z + a.w * b.w); }

struct PairQuadric {
  Pair xx, xy, xz, xt, yy, yz, yt, zz, zt, tt;
  Pair4 b;
  Pair c, weight;

  Pair4 times(const Pair4& d) const {
    return {xx * d.x + xy * d.y + xz * d.z + xt * d.w, xy * d.x + yy * d.y + yz * d.z + yt * d.w,
            xz * d.x + yz * d.y + zz * d.z + zt * d.w, xt * d.x + yt * d.y + zt * d.z + tt * d.w};
  }
  Pair valueWith(const Pair4& d, const Pair4& times_d) const {
    const Pair v = dot(d, times_d) + both(2) * dot(b, d) + c;
    return choose(v > both(0), v, both(0));
  }
  Pair value(const Pair4& d) const { return valueWith(d, times(d)); }
};

// Two quadrics moved by their offsets, each plus `more`.
PairQuadric sumOf(const Quadric& p, const Quadric& q, const Pair4& offset, const Quadric& more) {
  const Pair4 b{{p.b.x, q.b.x}, {p.b.y, q.b.y}, {p.b.z, q.b.z}, {p.b.w, q.b.w}};
  PairQuadric s{{p.xx, q.xx},
                {p.xy, q.xy},
                {p.xz, q.xz},
                {p.xt, q.xt},
                {p.yy, q.yy},
                {p.yz, q.yz},
                {p.yt, q.yt},
                {p.zz, q.zz},
                {p.zt, q.zt},
                {p.tt, q.tt},
                b,
                {p.c, q.c},
                {p.weight, q.weight}};
  const Pair4 moved = s.times(offset);
  s.c = s.valueWith(offset, moved) + both(more.c);
  s.b = {s.b.x + moved.x + both(more.b.x), s.b.y + moved.y + both(more.b.y), s.b.z + moved.z + both(more.b.z),
         s.b.w + moved.w + both(more.b.w)};
  s.xx += both(more.xx), s.xy += both(more.xy), s.xz += both(more.xz), s.xt += both(more.xt), s.yy += both(more.yy);
  s.yz += both(more.yz), s.yt += both(more.yt), s.zz += both(more.zz), s.zt += both(more.zt), s.tt += both(more.tt);
  s.weight += both(more.weight);
  return s;
}

// Both edges and what is needed of them; as Place and Track in placement.cpp, which say why.
class Places {
 public:
  Places(const PairQuadric& q, const Pair4& end, const Space& space) : q_(q), space_(space) {
    end_ = end;
    const Pair4 lengths = toLengths(end);
    length2_ = dot(lengths, lengths);
    middle_ = {both(0.5) * end.x, both(0.5) * end.y, both(0.5) * end.z, both(0.5) * end.w};
    follow();
  }

  Pair tieBreak() const { return both(kTieBreak) * q_.weight * length2_; }

  // The place at a time; false in `usable` where there is none.
  Pair4 at(Pair t, Mask& usable) const {
    const Pair4 place{p_.x - t * track_.x, p_.y - t * track_.y, p_.z - t * track_.z, t};
    const Pair4 from_middle =
        toLengths({place.x - middle_.x, place.y - middle_.y, place.z - middle_.z, place.w - middle_.w});
    usable = ok_ & isFinite(place.x + place.y + place.z + place.w) &
             (dot(from_middle, from_middle) <= both(kFarthest2) * length2_);
    return place;
  }
  Pair4 minimum(Mask& usable) const {
    const Pair4 place = at(right_ / slope_, usable);
    usable &= slope_ > both(0);
    return place;
  }

 private:
  Pair4 toLengths(const Pair4& d) const {
    const auto& m = space_.axes;
    return {both(m[0][0]) * d.x + both(m[1][0]) * d.y + both(m[2][0]) * d.z,
            both(m[0][1]) * d.x + both(m[1][1]) * d.y + both(m[2][1]) * d.z,
            both(m[0][2]) * d.x + both(m[1][2]) * d.y + both(m[2][2]) * d.z, both(space_.speed) * d.w};
  }

  void follow() {
    const Pair pull = both(kPull) * q_.weight;
    const auto pullAt = [&](int i, int j) { return pull * both(space_.square[i][j]); };
    const Pair xx = q_.xx + pullAt(0, 0), xy = q_.xy + pullAt(0, 1), xz = q_.xz + pullAt(0, 2),
               yy = q_.yy + pullAt(1, 1), yz = q_.yz + pullAt(1, 2), zz = q_.zz + pullAt(2, 2);
    const Pair ix = both(1) / xx, lyx = xy * ix, lzx = xz * ix, dy = yy - lyx * xy;
    const Pair iy = both(1) / dy, rest = yz - lzx * xy, lzy = rest * iy;
    const Pair dz = zz - lzx * xz - lzy * rest, iz = both(1) / dz;
    ok_ = (xx > both(0)) & (dy > both(0)) & (dz > both(0));
    const auto solve = [&](const Pair3& right) {
      const Pair y = right.y - lyx * right.x, z = (right.z - lzx * right.x - lzy * y) * iz;
      const Pair solved_y = y * iy - lzy * z;
      return Pair3{right.x * ix - lyx * solved_y - lzx * z, solved_y, z};
    };
    const auto rightAt = [&](int i, Pair b) {
      return -b + pullAt(i, 0) * middle_.x + pullAt(i, 1) * middle_.y + pullAt(i, 2) * middle_.z;
    };
    p_ = solve({rightAt(0, q_.b.x), rightAt(1, q_.b.y), rightAt(2, q_.b.z)});
    const Pair3 column{q_.xt, q_.yt, q_.zt};
    track_ = solve(column);
    const Pair pull_t = pull * both(space_.speed) * both(space_.speed);
    slope_ = q_.tt + pull_t - dot(column, track_);
    right_ = -q_.b.w + pull_t * middle_.w - dot(column, p_);
  }

  const PairQuadric& q_;
  const Space& space_;
  Pair4 end_{}, middle_{};
  Pair length2_{};
  Mask ok_{};
  Pair3 p_{}, track_{};
  Pair slope_{}, right_{};
};

struct Best {
  Pair4 at;
  Pair cost;
  Mask found;
  void offer(const Pair4& place, Pair place_cost, Mask usable) {
    const Mask better = usable & ~(found & (place_cost >= cost));
    at = {choose(better, place.x, at.x), choose(better, place.y, at.y), choose(better, place.z, at.z),
          choose(better, place.w, at.w)};
    cost = choose(better, place_cost, cost);
    found |= better;
  }
};

// Half to even, as nearbyint().
Pair rounded(Pair value) {
  const Pair large = both(6755399441055744.0);  // 1.5 * 2^52
  const Mask small = (value < both(0x1p51)) & (value > both(-0x1p51));
  return choose(small, (value + large) - large, value);
}

Mask isBetween(Pair offset, double from, float low, float high) {
  Mask mask{};
  for (int lane = 0; lane < 2; ++lane) {
    const auto p = static_cast<float>(from + offset[lane]);
    mask[lane] = p > low && p < high ? -1 : 0;
  }
  return mask;
}

}  // namespace

PairCosts costPair(const Quadric& from, const Vec4f& u, const std::array<const Quadric*, 2>& to,
                   const std::array<const Vec4f*, 2>& others, double align, bool frames, const Space& space,
                   const Bounds4f& domain) {
  const Vec4f &a = *others[0], &b = *others[1];
  const Pair4 end{Pair{a.x, b.x} - both(u.x), Pair{a.y, b.y} - both(u.y), Pair{a.z, b.z} - both(u.z),
                  Pair{a.t, b.t} - both(u.t)};
  const PairQuadric q = sumOf(*to[0], *to[1], {-end.x, -end.y, -end.z, -end.w}, from);
  const Places places(q, end, space);
  const Pair zero{};
  Best aligned{{zero, zero, zero, zero}, q.value({zero, zero, zero, zero}), ~Mask{}}, any{{}, zero, Mask{}};
  aligned.offer(end, q.value(end), ~Mask{});
  const Mask moves = end.w != zero;
  const auto offer = [&](Best& best, const Pair4& place, Mask usable) { best.offer(place, q.value(place), usable); };
  Mask usable{};
  Pair4 place = places.at(zero, usable);
  offer(aligned, place, usable);
  place = places.at(end.w, usable);
  offer(aligned, place, usable & moves);
  if (frames) {
    const Pair ut = both(u.t), vt{a.t, b.t};
    const Pair frame = rounded(both(0.5) * (ut + vt));
    const Mask between = (frame > choose(ut < vt, ut, vt)) & (frame < choose(ut < vt, vt, ut));
    place = places.at(frame - ut, usable);
    offer(aligned, place, usable & between);
  }
  place = places.minimum(usable);
  offer(any, place, usable & moves);
  const Mask is_aligned = ~any.found | (aligned.cost <= both(1 + align) * any.cost + places.tieBreak());
  const Pair4 at{choose(is_aligned, aligned.at.x, any.at.x), choose(is_aligned, aligned.at.y, any.at.y),
                 choose(is_aligned, aligned.at.z, any.at.z), choose(is_aligned, aligned.at.w, any.at.w)};
  const Pair value = choose(is_aligned, aligned.cost, any.cost), cost = value + places.tieBreak();
  const Mask usual =
      isBetween(at.x, u.x, domain.min.x, domain.max.x) & isBetween(at.y, u.y, domain.min.y, domain.max.y) &
      isBetween(at.z, u.z, domain.min.z, domain.max.z) & isBetween(at.w, u.t, domain.min.t, domain.max.t);
  PairCosts costs;
  for (int lane = 0; lane < 2; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    costs.cost[i] = cost[lane];
    costs.error[i] = q.weight[lane] > 0 ? std::sqrt(value[lane] / q.weight[lane]) : 0;
    costs.is_usual[i] = usual[lane] != 0;
  }
  return costs;
}

}  // namespace tet4d::qslim4d
