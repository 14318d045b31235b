#include "libpreprocess/measure/slice_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "formats/core/coordinates.h"
#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_measures.h"
#include "libpreprocess/measure/slice_points.h"

namespace tet4d::measure {

std::vector<double> sampleFrames(const hypermesh::File& reference, std::size_t count) {
  const double first = reference.header().domain.min.t, last = reference.header().domain.max.t;
  std::vector<double> frames;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double at = first + (last - first) * share;
    const double whole = std::round(at);
    // Off the middle between frames: there linear motion would hide an error of time.
    const double frame = i % 2 == 0 ? whole : std::floor(at) + 0.37;
    if (frame <= first || frame >= last) continue;
    if (frames.empty() || frame > frames.back()) frames.push_back(frame);
  }
  if (frames.empty()) frames.push_back(0.5 * (first + last));
  return frames;
}

SliceDistance compareSlices(const hypermesh::File& mesh, const hypermesh::File& reference,
                            const std::vector<double>& frames, const DistanceOptions& options,
                            outofcore::Executor& executor, outofcore::Progress& progress) {
  const auto& [min, max] = reference.header().domain;
  return compareSlices(slicesOf(mesh), slicesOf(reference), {reference.header().index_to_world, {min.x, min.y, min.z}},
                       frames, options, executor, progress);
}

SliceTimes sampleTimes(const Bounds4f& domain, std::size_t count) {
  const double first = domain.min.t, last = domain.max.t;
  SliceTimes times;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = first + (last - first) * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double frame = std::round(at), between = std::floor(at) + 0.37;
    if (frame > first && frame < last && (times.at.empty() || frame > times.at.back())) times.at.push_back(frame);
    if (between < last && (times.between.empty() || between > times.between.back())) times.between.push_back(between);
  }
  return times;
}

SliceSource slicesOf(const hypermesh::File& mesh) {
  return [&mesh](double frame) { return exchange::sliceHypermesh(mesh, frame); };
}

SliceSource slicesOf(std::span<const Vec4f> positions, std::span<const hypermesh::Tet> tets, float last_t) {
  return [=](double frame) {
    SliceMesh slice;
    sliceTets(tets, positions, {}, static_cast<float>(frame), last_t, slice);
    return slice;
  };
}

SliceDistance compareSlices(const SliceSource& mesh, const SliceSource& reference, const SliceFrame& where,
                            const std::vector<double>& frames, const DistanceOptions& options,
                            outofcore::Executor& executor, outofcore::Progress& progress) {
  SliceDistance result;
  double largest_volume = 0, largest_volume_error = 0;
  progress.phase("measure", frames.size());
  for (const double frame : frames) {
    const SliceMesh a = mesh(frame), b = reference(frame);
    const std::vector<Point3> pa = slicePoints(a, where.map, where.corner),
                              pb = slicePoints(b, where.map, where.corner);
    const SurfaceDistance d = surfaceDistance({pa, a.triangles}, {pb, b.triangles}, options, executor);
    SliceDifference slice{frame, d.rms(), d.p99(), d.max(), 0, 0, a.triangles.size(), b.triangles.size()};
    const SliceMeasures ma = measureSlice(a.positions, a.triangles, where.map);
    const SliceMeasures mb = measureSlice(b.positions, b.triangles, where.map);
    if (ma.bounds() && mb.bounds()) {
      slice.volume = ma.volume, slice.volume_reference = mb.volume;
      largest_volume = std::max(largest_volume, std::abs(mb.volume));
      largest_volume_error = std::max(largest_volume_error, std::abs(ma.volume - mb.volume));
    }
    result.rms += slice.rms / static_cast<double>(frames.size());
    result.p99 = std::max(result.p99, slice.p99);
    result.max = std::max(result.max, slice.max);
    result.slices.push_back(slice);
    progress.step(result.slices.size());
  }
  result.volume_error = largest_volume > 0 ? largest_volume_error / largest_volume : 0;
  return result;
}

SliceJudge::SliceJudge(const SliceSource& reference, SliceTimes times, SliceFrame where, DistanceOptions options)
    : times_(std::move(times)), where_(where), options_(options) {
  std::map<double, SliceMesh> slices;
  for (const auto* frames : {&times_.at, &times_.between}) {
    for (const double frame : *frames) slices.emplace(frame, reference(frame));
  }
  reference_ = [kept = std::move(slices)](double frame) { return kept.at(frame); };
}

SplitDistance SliceJudge::judge(const SliceSource& mesh, outofcore::Executor& executor, outofcore::Progress& progress) {
  return {compareSlices(mesh, reference_, where_, times_.at, options_, executor, progress),
          compareSlices(mesh, reference_, where_, times_.between, options_, executor, progress)};
}

}  // namespace tet4d::measure
