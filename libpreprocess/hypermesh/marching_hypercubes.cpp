#include "libpreprocess/hypermesh/marching_hypercubes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/bit_planes.h"
#include "libpreprocess/hypermesh/crossing.h"
#include "libpreprocess/hypermesh/frame_ring.h"
#include "libpreprocess/hypermesh/iso_part.h"
#include "libpreprocess/hypermesh/marching_plan.h"
#include "libpreprocess/hypermesh/slab_columns.h"
#include "libpreprocess/hypermesh/slab_tets.h"
#include "libpreprocess/hypermesh/split_tables.h"

namespace tet4d::hypermesh {
namespace {

// With one thread a frame is looked at while its layers are in the cache; with more, all at once, so that every thread
// has something to do.
std::uint64_t runBytes(const outofcore::Executor& executor) {
  return executor.threads() == 1 ? 256 * 1024 : ~std::uint64_t{0};
}

class Extraction {
 public:
  Extraction(exchange::FrameSource& source, PageSink& sink, const Options& options, outofcore::Executor& executor,
             outofcore::MemoryBudget& memory, outofcore::Progress& progress)
      : source_(source),
        sink_(sink),
        options_(options),
        executor_(executor),
        memory_(memory),
        progress_(progress),
        table_(tableOf(options.split)),
        shape_(gridShape(source.grid(), options)),
        isovalues_(options.isovalues()),
        kernels_(makeSampleKernels(source.grid().type, isovalues_, options.simd)),
        fixed_memory_(memory.reserve(plan(source, options).fixed_bytes, "frames and their bit planes")),
        ring_(source, framesHeld(options), runBytes(executor)),
        main_{*kernels_, [this](std::size_t frame) { return ring_.samples(frame); }},
        columns_(shape_, options, source.grid().index_to_world, main_, isovalues_.size()) {
    stats_.parts.resize(isovalues_.size());
    for (std::size_t i = 0; i < isovalues_.size(); ++i) {
      parts_.emplace_back(shape_, table_, *kernels_, i, options.simd);
      stats_.parts[i].isovalue = isovalues_[i];
    }
    for (const Field& field : options.fields) fields_.emplace_back(field, options.simd);
  }

  Stats run();

 private:
  void read();
  void classifyLayers(std::size_t frame, std::uint64_t z_begin, std::uint64_t z_end,
                      const std::function<void()>& digest);
  void classifyRow(std::size_t frame, std::uint64_t y, std::uint64_t z, std::uint64_t* scratch, SampleRange& range);
  void refuseNan(std::size_t frame) const;
  void startSlab(std::size_t slab);
  void checkVertexCounts(std::size_t slab) const;
  void extractPart(std::size_t slab, std::size_t p);
  void reserveTets(std::uint64_t count, std::size_t slab, const IsoPart& part);
  std::vector<std::uint64_t> countTets(const SlabTets& slab_tets, std::size_t p);
  Bounds4f boundsOf(const IsoPart& part, std::span<const Tet> tets, std::size_t slab) const;
  std::vector<Run> runsOf(std::size_t slab, std::size_t p) const;
  void addPage(std::size_t p, const SlabPage& page, std::span<const Run> runs, const Bounds4f& bounds);
  void addLastVertices(std::size_t frame);
  Stats finish(std::size_t frames);

  BitPlane& nanOf(std::size_t frame) { return nans_[frame % 3]; }
  const BitPlane& usableOf(std::size_t slab) const { return usable_[slab % 2]; }
  const std::byte* samplesOf(std::size_t frame) const { return ring_.samples(frame); }
  bool hasParts() const { return parts_.size() > 1; }
  // The last page of a mesh of one part also owns the last frame's vertices.
  bool joinsLast() const { return is_last_ && !hasParts(); }

  exchange::FrameSource& source_;
  PageSink& sink_;
  const Options& options_;
  outofcore::Executor& executor_;
  outofcore::MemoryBudget& memory_;
  outofcore::Progress& progress_;
  const CellTable& table_;
  const GridShape shape_;
  const std::vector<double> isovalues_;
  std::unique_ptr<SampleKernels> kernels_;
  outofcore::MemoryBudget::Reservation fixed_memory_, page_memory_;
  FrameRing ring_;
  FieldFrames main_;
  SlabColumns columns_;
  std::deque<FieldReader> fields_;
  std::vector<IsoPart> parts_;
  std::array<BitPlane, 3> nans_;    // by frame; empty without NaN, and where NaN is outside
  std::array<BitPlane, 2> usable_;  // cells by slab; empty for all
  std::unique_ptr<Tet[]> tets_;
  std::uint64_t tet_capacity_ = 0;
  std::uint64_t next_vertex_ = 0;
  bool is_last_ = false;  // the slab in hand
  SampleRange range_;
  Stats stats_;
};

// ---------------------------------------------------------------- frames

void Extraction::classifyRow(std::size_t frame, std::uint64_t y, std::uint64_t z, std::uint64_t* scratch,
                             SampleRange& range) {
  const std::size_t words = (shape_.samples(0) + 63) / 64;
  const std::size_t start = shape_.rowStart(y, z), row = shape_.row(y, z);
  const std::uint64_t count = shape_.samples(0);
  const std::byte* samples = samplesOf(frame) + shape_.sample(shape_.pad, y, z) * sampleBytes(source_.grid().type);
  std::array<std::uint64_t*, 64> signs{};
  std::array<RowState, 64> states{};
  for (std::size_t i = 0; i < parts_.size(); ++i)
    signs[i] = shape_.pad == 0 ? &parts_[i].signs(frame).inside[start] : scratch + i * words;
  BitPlane& nan = nanOf(frame);
  std::uint64_t* const nans = nan.empty() ? nullptr : shape_.pad == 0 ? &nan[start] : scratch + parts_.size() * words;
  kernels_->classifyRow(samples, count, std::span(signs.data(), parts_.size()), states.data(), nans, range);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    SignPlane& plane = parts_[i].signs(frame);
    const bool padded_inside = shape_.pad != 0 && states[i] == RowState::kInside;
    plane.rows[row] = padded_inside ? RowState::kMixed : states[i];
    if (shape_.pad != 0)
      shiftRow(std::span(signs[i], words), shape_.pad, std::span(&plane.inside[start], shape_.rowWords()));
  }
  if (nans != nullptr && shape_.pad != 0)
    shiftRow(std::span(nans, words), shape_.pad, std::span(&nan[start], shape_.rowWords()));
}

// Digesting is one task among those of the layers: the digest of a frame cannot be shared out.
void Extraction::classifyLayers(std::size_t frame, std::uint64_t z_begin, std::uint64_t z_end,
                                const std::function<void()>& digest) {
  std::vector<SampleRange> ranges(z_end - z_begin);
  executor_.run(z_end - z_begin + 1, [&](std::size_t task) {
    if (task == 0) return digest();
    const std::uint64_t z = z_begin + (task - 1) + shape_.pad;
    std::vector<std::uint64_t> scratch(shape_.pad == 0 ? 0 : (parts_.size() + 1) * shape_.rowWords());
    for (std::uint64_t y = shape_.pad; y < shape_.dims[1] - shape_.pad; ++y)
      classifyRow(frame, y, z, scratch.data(), ranges[task - 1]);
  });
  for (const SampleRange& range : ranges) range_.add(range);
}

void Extraction::refuseNan(std::size_t frame) const {
  const auto [x, y, z] = firstBit(shape_, nans_[frame % 3]);
  throw Error(FaultCode::kBadInput, source_.frameName(frame),
              "frame " + std::to_string(frame) + ", sample " + std::to_string(x - shape_.pad) + " " +
                  std::to_string(y - shape_.pad) + " " + std::to_string(z - shape_.pad),
              "is NaN", "leave such samples out with --nan mask, or count them as outside with --nan outside");
}

void Extraction::read() {
  const std::size_t frame = ring_.framesRead();
  progress_.phase("read", source_.times().size());
  progress_.step(frame);
  const std::uint64_t nans_before = range_.nan_samples;
  const bool keeps_nan = options_.nan != NanRule::kOutside;
  if (keeps_nan) nanOf(frame).assign(shape_.words(), 0);
  ring_.readNext([&](std::uint64_t z_begin, std::uint64_t z_end, const std::function<void()>& digest) {
    classifyLayers(frame, z_begin, z_end, digest);
  });
  if (range_.nan_samples == nans_before) nanOf(frame).clear();
  if (options_.nan == NanRule::kError && !nanOf(frame).empty()) refuseNan(frame);
  progress_.step(frame + 1);
}

// ---------------------------------------------------------------- pages

std::vector<std::uint64_t> Extraction::countTets(const SlabTets& slab_tets, std::size_t p) {
  const std::uint64_t layers = shape_.dims[2] - 1;
  std::vector<SlabTets::Count> counts(layers);
  executor_.run(layers, [&](std::size_t z) { counts[z] = slab_tets.countLayer(z); });
  std::vector<std::uint64_t> first{0};
  for (const SlabTets::Count& count : counts) {
    stats_.active_cells += count.active_cells;
    first.push_back(first.back() + count.tets);
  }
  stats_.parts[p].tets += first.back();
  return first;
}

// A box of the vertices the tetrahedra use.
Bounds4f Extraction::boundsOf(const IsoPart& part, std::span<const Tet> tets, std::size_t slab) const {
  Bounds4f bounds;
  if (tets.empty()) return bounds;
  if (usable_[0].empty() && usable_[1].empty()) {  // without masked cells every vertex is used
    for (const Vec4f& v : part.own()) bounds.add(v);
    for (const Vec4f& v : part.next()) bounds.add(v);
  } else {
    const auto &own = part.own(), &next = part.next();
    for (const Tet& tet : tets)
      for (const std::uint32_t i : tet) bounds.add(i < own.size() ? own[i] : next[i - own.size()]);
  }
  if (hasParts()) bounds.min.t = static_cast<float>(slab), bounds.max.t = static_cast<float>(slab + 1);
  return bounds;
}

// Where the next frame's vertices of part p will stand in the file.
std::vector<Run> Extraction::runsOf(std::size_t slab, std::size_t p) const {
  const std::uint64_t count = parts_[p].within(slab + 1).count;
  if (count == 0 || joinsLast()) return {};
  std::uint64_t first = next_vertex_;
  for (std::size_t q = p; q < parts_.size(); ++q) first += parts_[q].own().size();
  for (std::size_t q = 0; q < p; ++q) first += parts_[q].within(slab + 1).count + parts_[q].between(slab + 1).count;
  return {{first, count}};
}

void Extraction::addPage(std::size_t p, const SlabPage& page, std::span<const Run> runs, const Bounds4f& bounds) {
  IsoPart& part = parts_[p];
  std::vector<FieldFrames> fields;
  for (const FieldReader& field : fields_) fields.push_back(field.frames());
  const auto columns = columns_.build(part, p, page, source_.times(), fields, executor_);
  progress_.phase("write", source_.times().size() - 1);
  sink_.add({part.own(), runs, page.tets, bounds, columns, p});
  next_vertex_ += part.own().size();
  stats_.parts[p].vertices += part.own().size();
}

void Extraction::reserveTets(std::uint64_t count, std::size_t slab, const IsoPart& part) {
  const bool is_raw = options_.page_codec == paged::Codec::kRaw;
  const std::uint64_t page = part.own().size_bytes() + count * sizeof(Tet);
  page_memory_ = {};
  if (count > tet_capacity_) tets_.reset(), tet_capacity_ = 0;
  // The tetrahedra and columns; a page that is compressed is put together first, and stands there once more encoded.
  page_memory_ = memory_.reserve(std::max(count, tet_capacity_) * sizeof(Tet) +
                                     columns_.bytes(part.own().size(), part.next().size()) + (is_raw ? 0 : 2 * page),
                                 "slab " + std::to_string(slab) + " of the hypermesh");
  if (tets_ != nullptr || count == 0) return;
  tets_ = std::make_unique_for_overwrite<Tet[]>(count);
  tet_capacity_ = count;
}

void Extraction::extractPart(std::size_t slab, std::size_t p) {
  IsoPart& part = parts_[p];
  const SlabTets slab_tets = part.slabTets(slab, usableOf(slab));
  const std::vector<std::uint64_t> layers = countTets(slab_tets, p);
  if (joinsLast()) part.joinNext(memory_);
  reserveTets(layers.back(), slab, part);
  executor_.run(layers.size() - 1, [&](std::size_t z) {
    slab_tets.emitLayer(z, std::span(tets_.get() + layers[z], layers[z + 1] - layers[z]));
  });
  const std::span<const Tet> tets(tets_.get(), layers.back());
  progress_.step(slab + 1);
  addPage(p, {slab, joinsLast(), tets, layers}, runsOf(slab, p), boundsOf(part, tets, slab));
}

// ---------------------------------------------------------------- the run

void Extraction::checkVertexCounts(std::size_t slab) const {
  for (const IsoPart& part : parts_) {
    const std::uint64_t count = part.within(slab).count + part.between(slab).count + part.within(slab + 1).count;
    if (count >> 32 == 0) continue;
    throw Error(FaultCode::kBadInput, source_.frameName(slab), "slab " + std::to_string(slab),
                std::to_string(count) + " vertices, local indices can name 2^32 - 1", "cut the grid into parts");
  }
}

// Places E_k, takes in frame k + 2 where frame k stood, and numbers and places F_{k+1}: which of its vertices exist
// depends on the cells that frame masks.
void Extraction::startSlab(std::size_t slab) {
  progress_.phase("extract", source_.times().size() - 1);
  progress_.step(slab);
  if (!usableOf(slab).empty()) stats_.masked_cells += shape_.cells() - countBits(usableOf(slab));
  for (IsoPart& part : parts_) part.placeBetween(slab, samplesOf(slab), samplesOf(slab + 1), executor_, memory_);
  is_last_ = !source_.hasFrame(slab + 2);
  if (!is_last_) {
    if (slab + 2 > kMaxIndex) refuseFrames(source_, slab + 3);
    read();
    usable_[(slab + 1) % 2] = cellsWithoutNan(shape_, nanOf(slab + 1), nanOf(slab + 2));
  }
  progress_.phase("extract", source_.times().size() - 1);
  const BitPlane around = is_last_ ? usableOf(slab) : usableInEither(usableOf(slab), usableOf(slab + 1));
  for (IsoPart& part : parts_) {
    part.numberWithin(slab + 1, around, executor_);
    if (is_last_) {
      part.forgetBetween(slab + 1);
    } else {
      part.numberBetween(slab + 1, usableOf(slab + 1), executor_);
    }
    part.placeWithin(slab + 1, samplesOf(slab + 1), executor_, memory_);
  }
  checkVertexCounts(slab);
}

void Extraction::addLastVertices(std::size_t frame) {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const std::vector<std::uint64_t> no_layers{0};
    addPage(p, {frame, false, {}, no_layers}, {}, {});
  }
}

Stats Extraction::finish(std::size_t frames) {
  for (FieldReader& field : fields_) field.expectEnd();
  if (stats_.masked_cells > 0) sink_.addFlags(kInnerBoundary);
  if (source_.isStream()) sink_.setTimes(source_.times(), static_cast<float>(frames - 1));
  stats_.frames = frames;
  stats_.voxels = frames * source_.grid().voxels();
  stats_.nan_samples = range_.nan_samples;
  stats_.min_value = range_.min;
  stats_.max_value = range_.max;
  stats_.samples_xxh3 = ring_.digest();
  for (const FieldReader& field : fields_) stats_.fields_xxh3.push_back(field.digest());
  for (const Stats::Part& part : stats_.parts) stats_.vertices += part.vertices, stats_.tets += part.tets;
  return stats_;
}

Stats Extraction::run() {
  read();
  if (!source_.hasFrame(1)) refuseSingle(source_);
  read();
  usable_[0] = cellsWithoutNan(shape_, nanOf(0), nanOf(1));
  for (IsoPart& part : parts_) {
    part.numberWithin(0, usableOf(0), executor_);
    part.placeWithin(0, samplesOf(0), executor_, memory_);
    part.advance();
    part.numberBetween(0, usableOf(0), executor_);
  }
  std::size_t slab = 0;
  for (;; ++slab) {
    startSlab(slab);
    for (FieldReader& field : fields_) field.readTo(slab + 1, source_.times());
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      progress_.phase("extract", source_.times().size() - 1);
      extractPart(slab, p);
    }
    for (IsoPart& part : parts_) part.advance();
    progress_.step(slab + 1);
    if (is_last_) break;
  }
  if (hasParts()) addLastVertices(slab + 1);
  return finish(slab + 2);
}

}  // namespace

Stats buildHypermesh(exchange::FrameSource& source, PageSink& sink, const Options& options,
                     outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  checkSource(source, options);
  return Extraction(source, sink, options, executor, memory, progress).run();
}

Stats buildHypermesh(exchange::FrameSource& source, Writer& writer, const Options& options,
                     outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  FileSink sink(writer);
  return buildHypermesh(source, sink, options, executor, memory, progress);
}

}  // namespace tet4d::hypermesh
