// Quadrics of space-time: a squared distance as a symmetric 4x4 form, in double, about an origin of its own.
//
// Garland & Zhou 2005; Ponchio & Hormann 2008, sec. 5. A vertex's quadric is kept about the vertex itself, so that what
// is small is stored as small: no cancellation, however far from the grid's origin. 16 doubles, 128 bytes.
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace tet4d::qslim4d {

struct Quadric {
  // value(d) = d . A d + 2 b . d + c for the offset d from the origin. A by rows of its upper triangle.
  double xx = 0, xy = 0, xz = 0, xt = 0, yy = 0, yz = 0, yt = 0, zz = 0, zt = 0, tt = 0;
  glm::dvec4 b{0};
  double c = 0;
  double weight = 0;  // value / weight is a squared length

  // Adds scale * (n . d)^2: the squared distance to a hyperplane through the origin.
  void addPlane(const glm::dvec4& n, double scale, double plane_weight) {
    xx += scale * n.x * n.x, xy += scale * n.x * n.y, xz += scale * n.x * n.z, xt += scale * n.x * n.w;
    yy += scale * n.y * n.y, yz += scale * n.y * n.z, yt += scale * n.y * n.w;
    zz += scale * n.z * n.z, zt += scale * n.z * n.w, tt += scale * n.w * n.w;
    weight += plane_weight;
  }
  glm::dvec4 times(const glm::dvec4& d) const {
    return {xx * d.x + xy * d.y + xz * d.z + xt * d.w, xy * d.x + yy * d.y + yz * d.z + yt * d.w,
            xz * d.x + yz * d.y + zz * d.z + zt * d.w, xt * d.x + yt * d.y + zt * d.z + tt * d.w};
  }
  // Never below 0: what is below is rounding.
  double value(const glm::dvec4& d) const {
    const double v = glm::dot(d, times(d)) + 2 * glm::dot(b, d) + c;
    return v > 0 ? v : 0;
  }
  // The same function about an origin that lies at `offset` from the old one.
  Quadric about(const glm::dvec4& offset) const {
    Quadric moved = *this;
    const glm::dvec4 a_offset = times(offset);
    moved.c = value(offset);
    moved.b = b + a_offset;
    return moved;
  }
  void add(const Quadric& other) {
    xx += other.xx, xy += other.xy, xz += other.xz, xt += other.xt, yy += other.yy, yz += other.yz, yt += other.yt;
    zz += other.zz, zt += other.zt, tt += other.tt, b += other.b, c += other.c, weight += other.weight;
  }
  double at(int i, int j) const {
    const double rows[4][4] = {{xx, xy, xz, xt}, {xy, yy, yz, yt}, {xz, yz, zz, zt}, {xt, yt, zt, tt}};
    return rows[i][j];
  }
};
static_assert(sizeof(Quadric) == 16 * sizeof(double));

}  // namespace tet4d::qslim4d
