#include "libpreprocess/hypermesh/marching_hypercubes.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/hypermesh/bit_planes.h"
#include "libpreprocess/hypermesh/crossing.h"
#include "libpreprocess/hypermesh/frame_samples.h"
#include "libpreprocess/hypermesh/slab_tets.h"
#include "libpreprocess/hypermesh/split_tables.h"

namespace tet4d::hypermesh {
namespace {

// The samples an edge set's vertices are interpolated from.
template <class T>
struct EdgeSamples {
  const T* lower;       // at the edges' bases
  const T* upper;       // at their tips: the same frame, or the next
  std::uint64_t frame;  // number of the lower frame
};

template <class T>
class Extraction {
 public:
  Extraction(exchange::FrameSource& source, Writer& writer, const Options& options, outofcore::Executor& executor,
             outofcore::MemoryBudget& memory, outofcore::Progress& progress)
      : source_(source),
        writer_(writer),
        options_(options),
        executor_(executor),
        memory_(memory),
        progress_(progress),
        table_(tableOf(options.split)),
        shape_{source.grid().dims},
        frames_(source.times().size()),
        reader_(source) {}

  Stats run();

 private:
  void read(std::size_t frame);
  void placeVertices(const EdgeSet& set, const EdgeSamples<T>& samples, std::vector<Vec4f>& out);
  void extractSlab(std::size_t slab, std::unique_ptr<Tet[]>& tets, std::uint64_t& count);
  void writeSlab(std::size_t slab, std::span<const Tet> tets);
  std::vector<std::uint64_t> countTets(const SlabTets& slab_tets);
  Bounds4f boundsOf(std::span<const Tet> tets) const;

  // Frame k lives at k modulo 2, its bits at k modulo 3, usable cells of slab k and numbers of F_k at k modulo 2.
  T* samplesOf(std::size_t frame) { return samples_[frame % 2].data(); }
  FrameBits& bitsOf(std::size_t frame) { return bits_[frame % 3]; }
  BitPlane& usableOf(std::size_t slab) { return usable_[slab % 2]; }
  EdgeSet& withinOf(std::size_t frame) { return within_[frame % 2]; }
  bool isLast(std::size_t slab) const { return slab + 2 == frames_; }

  exchange::FrameSource& source_;
  Writer& writer_;
  const Options& options_;
  outofcore::Executor& executor_;
  outofcore::MemoryBudget& memory_;
  outofcore::Progress& progress_;
  const CellTable& table_;
  GridShape shape_;
  std::size_t frames_;
  FrameReader<T> reader_;
  SampleRange range_;
  Stats stats_;
  outofcore::MemoryBudget::Reservation position_memory_, page_memory_;

  std::array<std::vector<T>, 2> samples_;
  std::array<FrameBits, 3> bits_;
  std::array<BitPlane, 2> usable_;  // empty for all cells
  std::array<EdgeSet, 2> within_;   // F_k, F_{k+1}
  EdgeSet between_;                 // E_k
  std::vector<Vec4f> own_, next_;   // positions of the page's own vertices; of F_{k+1}
};

template <class T>
void Extraction<T>::read(std::size_t frame) {
  progress_.phase("read", frames_);
  progress_.step(frame);
  reader_.read(frame, samples_[frame % 2]);
  FrameBits& bits = bitsOf(frame);
  classify<T>(shape_, samples_[frame % 2], options_.iso, options_.nan != NanRule::kOutside, executor_, bits, range_);
  progress_.step(frame + 1);
  if (options_.nan != NanRule::kError || bits.nan.empty()) return;
  const auto [x, y, z] = firstBit(shape_, bits.nan);
  throw Error(FaultCode::kBadInput, source_.frameName(frame),
              "frame " + std::to_string(frame) + ", sample " + std::to_string(x) + " " + std::to_string(y) + " " +
                  std::to_string(z),
              "is NaN", "leave such samples out with --nan mask, or count them as outside with --nan outside");
}

template <class T>
void Extraction<T>::placeVertices(const EdgeSet& set, const EdgeSamples<T>& samples, std::vector<Vec4f>& out) {
  const std::size_t first = out.size();
  // While `out` grows, its old and its new place are held, beside the other set.
  position_memory_ = {};
  position_memory_ = memory_.reserve((own_.capacity() + next_.capacity() + first + set.count) * sizeof(Vec4f),
                                     "vertices of frame " + std::to_string(samples.frame));
  out.reserve(first + set.count);
  out.resize(first + set.count);
  const std::uint64_t row = shape_.dims[0], layer = row * shape_.dims[1];
  const double iso = options_.iso;
  executor_.run(shape_.dims[2], [&](std::size_t z) {
    for (const EdgePlane& plane : set.planes) {
      const unsigned axes = plane.axes;
      const std::uint64_t tip = (axes & 1U) + (axes >> 1 & 1U) * row + (axes >> 2 & 1U) * layer;
      const auto along = [&](unsigned axis, std::uint64_t index, double fraction) {
        return axes >> axis & 1U ? strictlyBetween(index, fraction) : static_cast<float>(index);
      };
      for (std::uint64_t y = 0; y < shape_.dims[1]; ++y) {
        for (std::size_t w = 0; w < shape_.rowWords(); ++w) {
          const std::size_t word = shape_.rowStart(y, z) + w;
          Vec4f* vertex = out.data() + first + plane.prefix[word];
          for (std::uint64_t rest = plane.bits[word]; rest; rest &= rest - 1) {
            const std::uint64_t x = w * 64 + static_cast<std::uint64_t>(std::countr_zero(rest));
            const std::uint64_t base = z * layer + y * row + x;
            const double fraction = crossingFraction(static_cast<double>(samples.lower[base]),
                                                     static_cast<double>(samples.upper[base + tip]), iso);
            *vertex++ = {along(0, x, fraction), along(1, y, fraction), along(2, z, fraction),
                         along(3, samples.frame, fraction)};
          }
        }
      }
    }
  });
}

// The box of the vertices the tetrahedra use.
template <class T>
Bounds4f Extraction<T>::boundsOf(std::span<const Tet> tets) const {
  Bounds4f bounds;
  if (tets.empty()) return bounds;
  if (usable_[0].empty() && usable_[1].empty()) {  // without masked cells every vertex is used
    for (const Vec4f& v : own_) bounds.add(v);
    for (const Vec4f& v : next_) bounds.add(v);
    return bounds;
  }
  for (const Tet& tet : tets)
    for (const std::uint32_t i : tet) bounds.add(i < own_.size() ? own_[i] : next_[i - own_.size()]);
  return bounds;
}

// Counts every layer's tetrahedra in parallel; returns where each layer begins, and the total at the end.
template <class T>
std::vector<std::uint64_t> Extraction<T>::countTets(const SlabTets& slab_tets) {
  const std::uint64_t layers = shape_.dims[2] - 1;
  std::vector<SlabTets::Count> counts(layers);
  executor_.run(layers, [&](std::size_t z) { counts[z] = slab_tets.countLayer(z); });
  std::vector<std::uint64_t> first{0};
  for (const SlabTets::Count& count : counts) {
    stats_.active_cells += count.active_cells;
    first.push_back(first.back() + count.tets);
  }
  return first;
}

template <class T>
void Extraction<T>::extractSlab(std::size_t slab, std::unique_ptr<Tet[]>& tets, std::uint64_t& count) {
  const EdgeSet& lower = withinOf(slab);
  EdgeSet& upper = withinOf(slab + 1);
  numberCutEdges(shape_, bitsOf(slab + 1).inside, bitsOf(slab + 1).inside,
                 isLast(slab) ? usableOf(slab) : usableInEither(usableOf(slab), usableOf(slab + 1)), executor_, upper);
  if ((lower.count + between_.count + upper.count) >> 32 != 0) {
    throw Error(
        FaultCode::kBadInput, source_.frameName(slab), "slab " + std::to_string(slab),
        std::to_string(lower.count + between_.count + upper.count) + " vertices, local indices can name 2^32 - 1",
        "cut the grid into parts");
  }
  next_.clear();
  placeVertices(upper, {samplesOf(slab + 1), samplesOf(slab + 1), slab + 1}, next_);

  const Slab planes{shape_, bitsOf(slab).inside, bitsOf(slab + 1).inside, usableOf(slab), lower, between_, upper};
  const SlabTets slab_tets(table_, planes);
  const std::vector<std::uint64_t> first = countTets(slab_tets);
  count = first.back();
  // The tetrahedra, the page's bytes and, if it is compressed, those once more; the last page also takes in `next_`.
  const std::uint64_t joined = isLast(slab) ? (own_.size() + next_.size()) * sizeof(Vec4f) : 0;
  const std::uint64_t page = std::max<std::uint64_t>(joined, own_.size() * sizeof(Vec4f)) + count * sizeof(Tet);
  page_memory_ = {};
  page_memory_ =
      memory_.reserve(count * sizeof(Tet) + joined + page * (options_.page_codec == paged::Codec::kRaw ? 1 : 2),
                      "slab " + std::to_string(slab) + " of the hypermesh");
  tets = std::make_unique_for_overwrite<Tet[]>(count);
  executor_.run(first.size() - 1, [&](std::size_t z) {
    slab_tets.emitLayer(z, std::span(tets.get() + first[z], first[z + 1] - first[z]));
  });
}

template <class T>
void Extraction<T>::writeSlab(std::size_t slab, std::span<const Tet> tets) {
  progress_.phase("write", frames_ - 1);
  const Bounds4f bounds = boundsOf(tets);
  if (isLast(slab)) {
    own_.reserve(own_.size() + next_.size());
    own_.insert(own_.end(), next_.begin(), next_.end());
    next_.clear();
  }
  std::vector<Run> runs;
  if (!next_.empty()) runs.push_back({writer_.nextVertex() + own_.size(), next_.size()});
  unwrap(writer_.addPage(own_, runs, tets, bounds));
  stats_.vertices += own_.size();
  stats_.tets += tets.size();
  progress_.step(slab + 1);
}

template <class T>
Stats Extraction<T>::run() {
  const auto fixed = memory_.reserve(plan(source_, options_).fixed_bytes, "two frames and their bit planes");
  for (std::vector<T>& frame : samples_) frame.resize(source_.grid().voxels());
  for (EdgeSet& set : within_) set = makeEdgeSet(shape_, table_.directions, false);
  between_ = makeEdgeSet(shape_, table_.directions, true);

  read(0);
  read(1);
  usableOf(0) = cellsWithoutNan(shape_, bitsOf(0), bitsOf(1));
  numberCutEdges(shape_, bitsOf(0).inside, bitsOf(0).inside, usableOf(0), executor_, withinOf(0));
  placeVertices(withinOf(0), {samplesOf(0), samplesOf(0), 0}, own_);
  for (std::size_t slab = 0; slab + 1 < frames_; ++slab) {
    progress_.phase("extract", frames_ - 1);
    progress_.step(slab);
    if (!usableOf(slab).empty()) stats_.masked_cells += shape_.cells() - countBits(usableOf(slab));
    numberCutEdges(shape_, bitsOf(slab).inside, bitsOf(slab + 1).inside, usableOf(slab), executor_, between_);
    placeVertices(between_, {samplesOf(slab), samplesOf(slab + 1), slab}, own_);
    // Frame `slab` has done its part: the frame after the next takes its place before the tetrahedra are made, because
    // which vertices of F_{slab+1} exist depends on the cells that frame masks.
    if (!isLast(slab)) {
      read(slab + 2);
      usableOf(slab + 1) = cellsWithoutNan(shape_, bitsOf(slab + 1), bitsOf(slab + 2));
    }
    progress_.phase("extract", frames_ - 1);
    std::unique_ptr<Tet[]> tets;
    std::uint64_t count = 0;
    extractSlab(slab, tets, count);
    progress_.step(slab + 1);
    writeSlab(slab, {tets.get(), count});
    std::swap(own_, next_);
  }
  if (stats_.masked_cells > 0) writer_.addFlags(kInnerBoundary);
  stats_.frames = frames_;
  stats_.voxels = frames_ * source_.grid().voxels();
  stats_.nan_samples = range_.nan_samples;
  stats_.min_value = range_.min;
  stats_.max_value = range_.max;
  stats_.samples_xxh3 = reader_.digest();
  return stats_;
}

}  // namespace

Stats buildHypermesh(exchange::FrameSource& source, Writer& writer, const Options& options,
                     outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  checkSource(source, options);
  if (fitsFloat(source.grid().type))
    return Extraction<float>(source, writer, options, executor, memory, progress).run();
  return Extraction<double>(source, writer, options, executor, memory, progress).run();
}

}  // namespace tet4d::hypermesh
