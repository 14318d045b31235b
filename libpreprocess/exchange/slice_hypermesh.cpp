#include "libpreprocess/exchange/slice_hypermesh.h"

#include <optional>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"

namespace tet4d::exchange {

Slice sliceHypermesh(const hypermesh::File& mesh, double frame, const SliceWants& wants) {
  const float t = sliceFrame(frame), last_t = mesh.header().domain.max.t;
  TetSlicer slicer(t, last_t);
  Slice slice;
  for (const std::size_t c : wants.columns) {
    const hypermesh::ColumnEntry& column = mesh.columns()[c];
    slice.columns.push_back({columnName(column), column.components, {}});
  }
  std::optional<TetVelocity> velocity;
  if (wants.velocity) velocity.emplace(mesh.header().index_to_world, mesh.times(), t);
  for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
    const Bounds4f& bounds = mesh.geometryEntry(k).bounds;
    const bool alive = bounds.min.t <= t && (t < bounds.max.t || (t == bounds.max.t && t == last_t));
    if (!alive || mesh.geometryEntry(k).counts[2] == 0) continue;
    if (wants.part && unwrap(mesh.partOf(k)) != *wants.part) continue;
    const hypermesh::GatheredPage page = unwrap(mesh.gather(k));
    const std::size_t vertices = slicer.mesh().keys.size();
    slicer.add(page.view.tets, page.positions, globalNumbers(page.view));
    const auto ends = slicer.ends().subspan(vertices);
    for (std::size_t c = 0; c < wants.columns.size() && !ends.empty(); ++c) {
      const std::vector<float> values = unwrap(mesh.gatherColumn(wants.columns[c], k, page.view));
      interpolateColumn(values, page.positions, ends, t, slice.columns[c]);
    }
    if (velocity) velocity->add(slicer, page.view.tets, page.positions);
  }
  slice.mesh = slicer.take();
  if (velocity) slice.columns.push_back(velocity->column(slice.mesh.positions.size()));
  return slice;
}

SliceMesh sliceHypermesh(const hypermesh::File& mesh, double frame) {
  return std::move(sliceHypermesh(mesh, frame, {}).mesh);
}

}  // namespace tet4d::exchange
