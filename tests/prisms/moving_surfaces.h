// Surfaces that move, made by formula, and the hypermeshes made of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/exchange/surface_source.h"
#include "libpreprocess/prisms/prisms.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::testing {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// A sequence in memory: `at(k)` gives the vertices of frame k, world units.
class FormulaSurface final : public exchange::SurfaceSource {
 public:
  using At = std::function<std::vector<std::array<double, 3>>(std::size_t)>;
  FormulaSurface(Triangles triangles, std::vector<double> times, At at);
  void readFrame(std::size_t k, std::span<Vec3f> positions) override;
  std::string frameName(std::size_t k) const override { return "formula frame " + std::to_string(k); }

 private:
  At at_;
};

std::vector<double> countTo(std::size_t frames);  // 0, 1, 2 …

// A torus of nu x nv vertices, counter-clockwise from outside; point(u, v) of [0, 1)^2 lies on radii 2 and 0.7.
Triangles torusTriangles(std::uint32_t nu, std::uint32_t nv);
std::vector<std::array<double, 3>> torusPoints(std::uint32_t nu, std::uint32_t nv);

// A hypermesh made of a source, open, and what the builder says.
struct Built {
  std::string path;
  hypermesh::File file;
  prisms::Stats stats;
};
Built build(const test::Scratch& scratch, exchange::SurfaceSource& source, const prisms::Options& options,
            std::size_t threads = 1, const std::string& name = "x.t4h");

// Proves faces, links (in core), bounds and checksums; returns the number of boundary faces that are no first or last
// frame's.
std::uint64_t expectManifold(const hypermesh::File& file);

// The largest distance, world units, of a vertex of the file's slice at frame k from the source's mesh at that frame,
// by trying every triangle. Also expects the slice to be closed.
double distanceAtFrame(const hypermesh::File& file, exchange::SurfaceSource& source, std::size_t k);

}  // namespace tet4d::testing
