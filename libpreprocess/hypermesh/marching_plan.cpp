// What can be said of a run before the first sample is read.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/crossing.h"
#include "libpreprocess/hypermesh/frame_samples.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"
#include "libpreprocess/hypermesh/split_tables.h"

namespace tet4d::hypermesh {

void checkSource(const exchange::FrameSource& source, const Options& options) {
  const auto bad = [&](const std::string& place, const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kBadInput, source.times().empty() ? "" : source.frameName(0), place, what, remedy);
  };
  if (!std::isfinite(options.iso)) {
    throw Error(FaultCode::kUsage, "", "option --iso", "the isovalue is not finite", "give a number such as 0.5");
  }
  if (source.times().size() < 2) {
    bad("", std::to_string(source.times().size()) + " frame; a hypermesh lies between frames and needs two at least",
        "give more frames, or slice a single one with a 3D tool");
  }
  if (source.times().size() - 1 > kMaxIndex) {
    bad("", std::to_string(source.times().size()) + " frames; f32 frame numbers allow " + std::to_string(kMaxIndex + 1),
        "cut the sequence into parts");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint64_t dim = source.grid().dims[axis];
    const std::string place = std::string("axis ") + "xyz"[axis];
    if (dim < 2)
      bad(place, std::to_string(dim) + " sample; cells need two at least", "repeat the slice to give it thickness");
    if (dim - 1 > kMaxIndex)
      bad(place, std::to_string(dim) + " samples; f32 positions allow " + std::to_string(kMaxIndex + 1),
          "cut the grid into parts");
  }
}

MeshHeader meshHeader(const exchange::FrameSource& source, const Options& options) {
  checkSource(source, options);
  const auto last = [](std::uint64_t count) { return static_cast<float>(count - 1); };
  const auto& dims = source.grid().dims;
  MeshHeader header{};
  header.flags = kOnGrid;
  header.index_to_world = source.grid().index_to_world;
  header.domain.min = {0, 0, 0, 0};
  header.domain.max = {last(dims[0]), last(dims[1]), last(dims[2]), last(source.times().size())};
  header.isovalue = options.iso;
  return header;
}

Plan plan(const exchange::FrameSource& source, const Options& options) {
  checkSource(source, options);
  const exchange::GridInfo& grid = source.grid();
  const GridShape shape{grid.dims};
  const CellTable& table = tableOf(options.split);
  const bool as_float = fitsFloat(grid.type);
  const auto within = static_cast<std::size_t>(
      std::count_if(table.directions.begin(), table.directions.end(), [](const auto& d) { return d.axes < 8; }));
  const std::size_t through = table.directions.size() - within;
  // Signs and NaNs of three frames, and the planes that masking derives from them.
  const std::uint64_t sign_planes = options.nan == NanRule::kMask ? 6 + 3 + table.directions.size() : 4;

  Plan plan;
  plan.fixed_bytes = 2 * grid.voxels() * (as_float ? sizeof(float) : sizeof(double)) +
                     (as_float ? FrameReader<float>::bytes(grid) : FrameReader<double>::bytes(grid)) +
                     sign_planes * shape.words() * sizeof(std::uint64_t) + edgeSetBytes(shape, 2 * within + through);
  // The hull table is read-only data of the program; the Kuhn table is made at run time.
  if (options.split == Split::kKuhn) plan.fixed_bytes += table.tets.size_bytes() + table.offsets.size_bytes();
  const std::uint64_t slabs = source.times().size() - 1;
  const std::uint64_t most_tets = shape.cells() * table.max_tets;
  const std::uint64_t frame_vertices = grid.voxels() * within, slab_vertices = grid.voxels() * through;
  const std::uint64_t page = (2 * frame_vertices + slab_vertices) * sizeof(Vec4f) + most_tets * sizeof(Tet);
  plan.most_page_bytes = page * (options.page_codec == paged::Codec::kRaw ? 2 : 3);
  // Every slab has an aligned page, if only to say that it is empty; then come page table, times and header.
  plan.least_output_bytes = slabs * (container::kPageAlignment + sizeof(paged::PageEntry)) +
                            source.times().size() * sizeof(double) + sizeof(MeshHeader);
  const std::uint64_t overhead = plan.least_output_bytes + 4096;
  plan.most_output_bytes = overhead + slabs * most_tets * sizeof(Tet) +
                           (slabs * (frame_vertices + slab_vertices) + frame_vertices) * sizeof(Vec4f) +
                           slabs * container::kPageAlignment;
  return plan;
}

}  // namespace tet4d::hypermesh
