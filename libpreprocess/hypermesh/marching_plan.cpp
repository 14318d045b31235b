// What can be said of a run before the first sample is read.
#include "libpreprocess/hypermesh/marching_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/crossing.h"
#include "libpreprocess/hypermesh/frame_ring.h"
#include "libpreprocess/hypermesh/iso_part.h"
#include "libpreprocess/hypermesh/split_tables.h"

namespace tet4d::hypermesh {
namespace {

void checkIsovalues(const Options& options) {
  std::vector<double> isovalues = options.isovalues();
  const auto bad = [](const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kUsage, "", "option --iso", what, remedy);
  };
  for (const double iso : isovalues)
    if (!std::isfinite(iso)) bad("the isovalue is not finite", "give a number such as 0.5");
  if (isovalues.size() > kMaxParts) {
    bad(std::to_string(isovalues.size()) + " isovalues, one run takes " + std::to_string(kMaxParts),
        "make several hypermeshes");
  }
  std::sort(isovalues.begin(), isovalues.end());
  if (std::adjacent_find(isovalues.begin(), isovalues.end()) != isovalues.end())
    bad("an isovalue is given twice", "give each once");
}

void checkAxes(const exchange::FrameSource& source, const Options& options) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint64_t dim = source.grid().dims[axis];
    const auto bad = [&](const std::string& what, const std::string& remedy) {
      throw Error(FaultCode::kBadInput, source.times().empty() ? "" : source.frameName(0),
                  std::string("axis ") + "xyz"[axis], what, remedy);
    };
    if (dim < 2) bad(std::to_string(dim) + " sample; cells need two at least", "repeat the slice to give it thickness");
    if (options.pad > kMaxPad) {
      throw Error(FaultCode::kUsage, "", "option --pad",
                  std::to_string(options.pad) + " layers, at most " + std::to_string(kMaxPad) + " are possible",
                  "one layer closes the surface: --cap");
    }
    if (dim - 1 + options.pad > kMaxIndex)
      bad(std::to_string(dim) + " samples and " + std::to_string(options.pad) + " of padding; f32 positions allow " +
              std::to_string(kMaxIndex + 1),
          "cut the grid into parts");
  }
}

void checkField(const exchange::FrameSource& source, const Field& field) {
  const auto text = [](const std::array<std::uint64_t, 3>& size) {
    return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]);
  };
  const exchange::GridInfo &ours = source.grid(), &theirs = field.frames->grid();
  if (theirs.dims != ours.dims)
    refuseField(field, "its grid is " + text(theirs.dims) + ", but the frames have " + text(ours.dims));
  if (!isSameGrid(ours.index_to_world, theirs.index_to_world))
    refuseField(field, "its grid's spacing, axes or origin differ from those of the frames");
  if (source.isStream() || field.frames->isStream()) return;  // compared while they come
  const std::vector<double>&frames = source.times(), &times = field.frames->times();
  if (times.size() != frames.size()) {
    refuseField(field, std::to_string(times.size()) + " frames, but there are " + std::to_string(frames.size()));
  }
  for (std::size_t k = 0; k < times.size(); ++k) checkFieldTime(field, k, frames);
}

}  // namespace

std::vector<double> Options::isovalues() const {
  std::vector<double> all{iso};
  all.insert(all.end(), more_isos.begin(), more_isos.end());
  return all;
}

GridShape gridShape(const exchange::GridInfo& grid, const Options& options) {
  GridShape shape{grid.dims, options.pad};
  for (std::uint64_t& dim : shape.dims) dim += 2 * options.pad;
  return shape;
}

std::size_t framesHeld(const Options& options) { return options.normals == Normals::kGradient ? 4 : 2; }

void refuseFrames(const exchange::FrameSource& source, std::size_t frames) {
  throw Error(FaultCode::kBadInput, source.frameName(0), "",
              std::to_string(frames) + " frames; f32 frame numbers allow " + std::to_string(kMaxIndex + 1),
              "cut the sequence into parts");
}

void refuseSingle(const exchange::FrameSource& source) {
  throw Error(FaultCode::kBadInput, source.times().empty() ? "" : source.frameName(0), "",
              std::to_string(source.times().size()) + " frame; a hypermesh lies between frames and needs two at least",
              "give more frames, or slice a single one with a 3D tool");
}

void refuseField(const Field& field, const std::string& what) {
  throw Error(FaultCode::kBadInput, field.frames->times().empty() ? "" : field.frames->frameName(0),
              "field " + field.name, what, "a field needs a sample for each of the frames' samples, at their times");
}

void checkFieldTime(const Field& field, std::size_t frame, std::span<const double> times) {
  const double theirs = field.frames->times()[frame], ours = times[frame];
  // Decimal texts of one clock may differ in their last digits, by far less than a step.
  const double step = times[std::max<std::size_t>(frame, 1)] - times[std::max<std::size_t>(frame, 1) - 1];
  if (std::abs(theirs - ours) <= 1e-6 * step) return;
  refuseField(field, "its frame " + std::to_string(frame) + " is at time " + std::to_string(theirs) +
                         ", but that of the frames is " + std::to_string(ours));
}

void checkSource(exchange::FrameSource& source, const Options& options) {
  checkIsovalues(options);
  // A stream's second frame comes when the first is read.
  if (!source.hasFrame(0) || (!source.isStream() && !source.hasFrame(1))) refuseSingle(source);
  if (source.times().size() - 1 > kMaxIndex) refuseFrames(source, source.times().size());
  checkAxes(source, options);
  for (const Field& field : options.fields) checkField(source, field);
}

std::vector<Writer::Column> columnsOf(const Options& options) {
  std::vector<Writer::Column> columns;
  if (options.normals != Normals::kNone) columns.push_back({"normal", 3});
  if (options.velocity) columns.push_back({"velocity", 3});
  for (const Field& field : options.fields) columns.push_back({field.name, 1});
  return columns;
}

MeshHeader meshHeader(exchange::FrameSource& source, const Options& options) {
  checkSource(source, options);
  const auto& dims = source.grid().dims;
  const auto pad = static_cast<float>(options.pad);
  const auto last = [&](std::size_t axis) { return static_cast<float>(dims[axis] - 1 + options.pad); };
  MeshHeader header{};
  header.flags = kOnGrid;
  header.index_to_world = source.grid().index_to_world;
  header.domain.min = {0 - pad, 0 - pad, 0 - pad, 0};  // no -0 where there is no padding
  header.domain.max = {last(0), last(1), last(2), static_cast<float>(source.times().size() - 1)};
  header.isovalue = options.more_isos.empty() ? options.iso : std::numeric_limits<double>::quiet_NaN();
  return header;
}

Writer createWriter(const std::string& path, exchange::FrameSource& source, const Options& options, bool force) {
  const MeshHeader header = meshHeader(source, options);
  const std::vector<Writer::Column> columns = columnsOf(options);
  const std::vector<double> parts = options.more_isos.empty() ? std::vector<double>{} : options.isovalues();
  return unwrap(Writer::create(path, header, source.times(), columns, options.page_codec, force, parts));
}

Plan plan(exchange::FrameSource& source, const Options& options) {
  checkSource(source, options);
  const exchange::GridInfo& grid = source.grid();
  const GridShape shape = gridShape(grid, options);
  const CellTable& table = tableOf(options.split);
  const std::uint64_t parts = options.isovalues().size();
  const auto within = static_cast<std::size_t>(
      std::count_if(table.directions.begin(), table.directions.end(), [](const auto& d) { return d.axes < 8; }));
  const std::size_t through = table.directions.size() - within;
  // NaNs of three frames, and the planes that masking derives from them.
  const std::uint64_t nan_planes = options.nan == NanRule::kMask    ? 3 + 3 + table.directions.size()
                                   : options.nan == NanRule::kError ? 3
                                                                    : 0;

  Plan plan;
  plan.fixed_bytes = FrameRing::bytes(grid, framesHeld(options)) + parts * IsoPart::bytes(shape, table) +
                     nan_planes * shape.words() * sizeof(std::uint64_t);
  for (const Field& field : options.fields) plan.fixed_bytes += FrameRing::bytes(field.frames->grid(), 2);
  // The hull table is read-only data of the program; the Kuhn table is made at run time.
  if (options.split == Split::kKuhn) plan.fixed_bytes += table.tets.size_bytes() + table.offsets.size_bytes();
  const std::uint64_t slabs = source.times().size() - 1;
  const std::uint64_t most_tets = shape.cells() * table.max_tets;
  const std::uint64_t points = shape.words() * 64;
  const std::uint64_t frame_vertices = points * within, slab_vertices = points * through;
  std::uint64_t components = 0;
  for (const Writer::Column& column : columnsOf(options)) components += column.components;
  const std::uint64_t columns =
      components * sizeof(float) + (options.normals == Normals::kTets || options.velocity ? 32 : 0);
  const std::uint64_t page = (2 * frame_vertices + slab_vertices) * (sizeof(Vec4f) + columns) + most_tets * sizeof(Tet);
  // Positions of every part; the tetrahedra of one. A page that is compressed stands there twice more.
  plan.most_page_bytes = page * (options.page_codec == paged::Codec::kRaw ? 2 : 3) +
                         (parts - 1) * (2 * frame_vertices + slab_vertices) * (sizeof(Vec4f) + columns);
  // Every slab has an aligned page, if only to say that it is empty; then come page table, times and header.
  plan.least_output_bytes = parts * slabs * (container::kPageAlignment + sizeof(paged::PageEntry)) +
                            source.times().size() * sizeof(double) + sizeof(MeshHeader);
  const std::uint64_t overhead = plan.least_output_bytes + 4096;
  plan.most_output_bytes =
      overhead + parts * (slabs * most_tets * sizeof(Tet) +
                          (slabs * (frame_vertices + slab_vertices) + frame_vertices) *
                              (sizeof(Vec4f) + components * sizeof(float)) +
                          (slabs + 1) * (1 + columnsOf(options).size()) * container::kPageAlignment);
  return plan;
}

}  // namespace tet4d::hypermesh
