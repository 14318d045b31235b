#include "libpreprocess/hypermesh/slab_columns.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "libpreprocess/hypermesh/marching_plan.h"

namespace tet4d::hypermesh {
namespace {

bool needsSums(const Options& options) {
  return options.normals == Normals::kTets || (options.velocity && options.normals == Normals::kNone);
}

// Diagonal of the lattice in world units.
double diagonalOf(const GridShape& shape, const AffineMap& map) {
  std::array<double, 3> sum{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t c = 0; c < 3; ++c)
      sum[c] += std::abs(map.axes[axis][c]) * static_cast<double>(shape.dims[axis] - 1);
  return std::hypot(sum[0], sum[1], sum[2]);
}

}  // namespace

FieldReader::FieldReader(const Field& field, Simd simd)
    : field_(field),
      kernels_(makeSampleKernels(field.frames->grid().type, {}, simd)),
      ring_(*field.frames, 2, 1 << 20) {}

void FieldReader::readTo(std::size_t frame, std::span<const double> times) {
  while (ring_.framesRead() <= frame) {
    const std::size_t next = ring_.framesRead();
    if (!field_.frames->hasFrame(next))
      refuseField(field_, "it ends after " + std::to_string(next) + " frames, but there are more");
    checkFieldTime(field_, next, times);
    ring_.readNext([](std::uint64_t, std::uint64_t, const std::function<void()>& digest) { digest(); });
  }
}

void FieldReader::expectEnd() {
  if (field_.frames->hasFrame(ring_.framesRead()))
    refuseField(field_, "it has more frames than the " + std::to_string(ring_.framesRead()) + " there are");
}

FieldFrames FieldReader::frames() const {
  return {*kernels_, [this](std::size_t frame) { return ring_.samples(frame); }};
}

SlabColumns::SlabColumns(const GridShape& shape, const Options& options, const AffineMap& map, const FieldFrames& main,
                         std::size_t parts)
    : shape_(shape),
      options_(options),
      map_(map, diagonalOf(shape, map)),
      main_(main),
      sums_(needsSums(options) ? parts : 0),
      values_(columnsOf(options).size()) {}

std::uint64_t SlabColumns::bytes(std::uint64_t own, std::uint64_t next) const {
  std::uint64_t components = 0;
  for (const Writer::Column& column : columnsOf(options_)) components += column.components;
  return own * components * sizeof(float) + (sums_.empty() ? 0 : (own + next) * sizeof(Normal4));
}

// F_k, E_k and, on the last page, F_{k+1}: the order of the page's own vertices.
void SlabColumns::forOwnEdges(const IsoPart& part, const SlabPage& page, outofcore::Executor& executor,
                              const std::function<void(const LatticeEdge&, std::size_t)>& visit) const {
  std::size_t first = 0;
  const auto walk = [&](const EdgeSet& set, std::size_t frame) {
    if (set.count == 0) return;
    forEachEdge(shape_, set, frame, part.own().subspan(first, set.count), executor,
                [&](const LatticeEdge& edge, std::size_t i) { visit(edge, first + i); });
    first += set.count;
  };
  walk(part.within(page.slab), page.slab);
  walk(part.between(page.slab), page.slab);
  if (page.is_last) walk(part.within(page.slab + 1), page.slab + 1);
}

void SlabColumns::addNormals(const IsoPart& part, std::size_t p, const SlabPage& page, std::span<const double> times,
                             outofcore::Executor& executor) {
  const bool has_normal = options_.normals != Normals::kNone;
  std::vector<float>* const normal = has_normal ? &values_[0] : nullptr;
  std::vector<float>* const velocity = options_.velocity ? &values_[has_normal ? 1 : 0] : nullptr;
  for (std::vector<float>* column : {normal, velocity})
    if (column != nullptr) column->resize(3 * part.own().size());
  const std::size_t before = std::min(page.slab, times.size() - 2);  // the last frame has the slab in front of it
  const double frame_time = times[before + 1] - times[before];
  const auto set = [&](std::size_t v, const Normal4& n) {
    map_.columns(n, frame_time, normal != nullptr ? &(*normal)[3 * v] : nullptr,
                 velocity != nullptr ? &(*velocity)[3 * v] : nullptr);
  };
  if (options_.normals == Normals::kGradient) {
    forOwnEdges(part, page, executor, [&](const LatticeEdge& edge, std::size_t v) {
      set(v, gradientNormalAt(shape_, main_, times, times.size(), edge));
    });
    return;
  }
  NormalSums& sums = sums_[p];
  if (!page.tets.empty()) sums.add(page.tets, page.layers, part.own(), part.next(), frame_time, executor);
  sums.extendTo(part.own().size() + part.next().size());
  for (std::size_t v = 0; v < part.own().size(); ++v) set(v, sums[v]);
  sums.advance(part.own().size());
}

std::span<const std::span<const float>> SlabColumns::build(const IsoPart& part, std::size_t p, const SlabPage& page,
                                                           std::span<const double> times,
                                                           std::span<const FieldFrames> fields,
                                                           outofcore::Executor& executor) {
  if (options_.normals != Normals::kNone || options_.velocity) addNormals(part, p, page, times, executor);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    std::vector<float>& column = values_[values_.size() - fields.size() + f];
    column.resize(part.own().size());
    forOwnEdges(part, page, executor, [&](const LatticeEdge& edge, std::size_t v) {
      column[v] = static_cast<float>(fieldAt(shape_, fields[f], edge));
    });
  }
  spans_.assign(values_.begin(), values_.end());
  return spans_;
}

}  // namespace tet4d::hypermesh
