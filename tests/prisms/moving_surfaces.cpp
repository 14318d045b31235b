#include "tests/prisms/moving_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_measures.h"
#include "libpreprocess/outofcore/executor.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"

namespace tet4d::testing {
namespace {

using Point = std::array<double, 3>;

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point plus(const Point& a, double s, const Point& d) { return {a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2]}; }

double toSegment(const Point& p, const Point& a, const Point& b) {
  const Point d = minus(b, a);
  const double length = dot(d, d), s = length > 0 ? std::clamp(dot(minus(p, a), d) / length, 0.0, 1.0) : 0;
  const Point off = minus(p, plus(a, s, d));
  return std::sqrt(dot(off, off));
}

double toTriangle(const Point& p, const Point& a, const Point& b, const Point& c) {
  const Point u = minus(b, a), v = minus(c, a), w = minus(p, a);
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), area = uu * vv - uv * uv;
  if (area > 0) {
    const double s = (vv * dot(w, u) - uv * dot(w, v)) / area, t = (uu * dot(w, v) - uv * dot(w, u)) / area;
    if (s >= 0 && t >= 0 && s + t <= 1) {
      const Point off = minus(p, plus(plus(a, s, u), t, v));
      return std::sqrt(dot(off, off));
    }
  }
  return std::min({toSegment(p, a, b), toSegment(p, b, c), toSegment(p, c, a)});
}

}  // namespace

FormulaSurface::FormulaSurface(Triangles triangles, std::vector<double> times, At at) : at_(std::move(at)) {
  const auto first = at_(0);
  info_.vertices = first.size();
  info_.triangles = std::move(triangles);
  info_.index_to_world = exchange::mapNear(first);
  info_.times = std::move(times);
}

void FormulaSurface::readFrame(std::size_t k, std::span<Vec3f> positions) {
  const auto points = at_(k);
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = exchange::placed(points[i], info_.index_to_world, frameName(k), i);
}

std::vector<double> countTo(std::size_t frames) {
  std::vector<double> times(frames);
  for (std::size_t k = 0; k < frames; ++k) times[k] = static_cast<double>(k);
  return times;
}

Triangles torusTriangles(std::uint32_t nu, std::uint32_t nv) {
  Triangles triangles;
  for (std::uint32_t u = 0; u < nu; ++u) {
    for (std::uint32_t v = 0; v < nv; ++v) {
      const std::uint32_t a = u * nv + v, b = (u + 1) % nu * nv + v, c = (u + 1) % nu * nv + (v + 1) % nv,
                          d = u * nv + (v + 1) % nv;
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  return triangles;
}

std::vector<std::array<double, 3>> torusPoints(std::uint32_t nu, std::uint32_t nv) {
  std::vector<std::array<double, 3>> points;
  for (std::uint32_t u = 0; u < nu; ++u) {
    for (std::uint32_t v = 0; v < nv; ++v) {
      const double a = 2 * std::numbers::pi * u / nu, b = 2 * std::numbers::pi * v / nv, r = 2 + 0.7 * std::cos(b);
      points.push_back({r * std::cos(a), r * std::sin(a), 0.7 * std::sin(b)});
    }
  }
  return points;
}

Built build(const test::Scratch& scratch, exchange::SurfaceSource& source, const prisms::Options& options,
            std::size_t threads, const std::string& name) {
  const std::string path = scratch.path(name);
  hypermesh::Writer writer = unwrap(
      hypermesh::Writer::create(path, prisms::meshHeader(source), source.info().times, {}, options.page_codec, true));
  outofcore::ThreadExecutor executor(threads);
  outofcore::MemoryBudget memory;
  outofcore::Progress progress;
  const prisms::Stats stats = prisms::buildPrisms(source, writer, options, executor, memory, progress);
  unwrap(writer.close("{}"));
  return {path, unwrap(hypermesh::File::open(path)), stats};
}

std::uint64_t expectManifold(const hypermesh::File& file) {
  const Status status = file.verify();
  EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.fault().what);
  outofcore::Progress progress;
  const auto faces = topology::checkHypermesh(file, progress);
  EXPECT_TRUE(faces.ok()) << (faces.faults.empty() ? "" : faces.faults.front());
  EXPECT_EQ(faces.unused_vertices, 0u);
  outofcore::MemoryBudget memory;
  const auto links = topology::checkLinks(file, memory, progress);
  EXPECT_TRUE(links.ok()) << (links.faults.empty() ? "" : links.faults.front());
  return faces.inner_boundary_faces;
}

double distanceAtFrame(const hypermesh::File& file, exchange::SurfaceSource& source, std::size_t k) {
  const SliceMesh slice = exchange::sliceHypermesh(file, static_cast<double>(k));
  EXPECT_TRUE(measure::measureSlice(slice.positions, slice.triangles).closed()) << "frame " << k;
  std::vector<Vec3f> positions(source.info().vertices);
  source.readFrame(k, positions);
  const AffineMap& map = file.header().index_to_world;
  const auto world = [&](const Vec3f& p) { return toWorld(map, {p.x, p.y, p.z}); };
  double worst = 0;
  for (const Vec3f& p : slice.positions) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : source.info().triangles)
      nearest = std::min(nearest, toTriangle(world(p), world(positions[a]), world(positions[b]), world(positions[c])));
    worst = std::max(worst, nearest);
  }
  return worst;
}

}  // namespace tet4d::testing
