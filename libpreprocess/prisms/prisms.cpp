#include "libpreprocess/prisms/prisms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/foreign_runs.h"
#include "libpreprocess/exchange/write_surfaces.h"
#include "libpreprocess/prisms/lifelines.h"
#include "libpreprocess/prisms/prism_error.h"
#include "libpreprocess/prisms/prism_pages.h"
#include "libpreprocess/prisms/surface_edges.h"
#include "libpreprocess/prisms/window.h"

namespace tet4d::prisms {
namespace {

constexpr std::uint64_t kMaxFrame = std::uint64_t{1} << 22;  // exact as f32, with fractions between
constexpr double kF32Step = 0x1p-23;
constexpr double kMargin = 1.0 / 64;  // of the domain around the mesh, in extents

unsigned stepsOf(const exchange::SurfaceSource& source, const Options& options) {
  return static_cast<unsigned>(std::min<std::uint64_t>(options.linear_window, source.info().times.size() - 1));
}

class Run {
 public:
  Run(exchange::SurfaceSource& source, hypermesh::Writer& writer, const Options& options, outofcore::Executor& executor,
      outofcore::MemoryBudget& memory, outofcore::Progress& progress)
      : source_(source),
        info_(source.info()),
        writer_(writer),
        options_(options),
        executor_(executor),
        memory_(memory),
        progress_(progress),
        length_(info_.index_to_world),
        last_(info_.times.size() - 1),
        digest_(info_) {}

  Stats run();

 private:
  void lookAtSurface();
  void read(std::uint64_t frame, std::vector<Vec3f>& positions);
  void setTolerance();
  void buildWindow();
  void writePage(unsigned frame, const KeptNumbers& numbers, std::span<const Kept> kept);
  void finish();

  exchange::SurfaceSource& source_;
  const exchange::SurfaceInfo& info_;
  hypermesh::Writer& writer_;
  const Options& options_;
  outofcore::Executor& executor_;
  outofcore::MemoryBudget& memory_;
  outofcore::Progress& progress_;
  WorldLength length_;
  std::uint64_t last_;  // frame
  Window window_;
  std::vector<Edge> edges_;
  std::vector<std::uint8_t> used_;  // by vertex
  exchange::SurfaceDigest digest_;
  Bounds4f bounds_;
  Stats stats_;
  outofcore::MemoryBudget::Reservation page_memory_;
};

void Run::lookAtSurface() {
  SurfaceEdges surface = surfaceEdges(info_.triangles);
  edges_ = std::move(surface.edges);
  stats_.open_edges = surface.open;
  stats_.edges_over_two = surface.over_two;
  stats_.misoriented_edges = surface.misoriented;
  used_.assign(info_.vertices, 0);
  for (const Triangle& t : info_.triangles)
    for (const std::uint32_t v : t) used_[v] = 1;
  stats_.unused_vertices = static_cast<std::uint64_t>(std::count(used_.begin(), used_.end(), 0));
}

void Run::read(std::uint64_t frame, std::vector<Vec3f>& positions) {
  progress_.step(frame);
  positions.resize(info_.vertices);
  source_.readFrame(frame, positions);
  digest_.add(positions);
}

// A part of the first frame's diagonal becomes a length.
void Run::setTolerance() {
  stats_.tolerance = options_.linear_tolerance;
  if (!options_.relative) return;
  Bounds4f box;
  for (std::size_t v = 0; v < used_.size(); ++v) {
    const Vec3f& p = window_.frames[0][v];
    if (used_[v] != 0) box.add(Vec4f{p.x, p.y, p.z, 0});
  }
  stats_.tolerance *= std::sqrt(
      length_.squared(double{box.max.x} - box.min.x, double{box.max.y} - box.min.y, double{box.max.z} - box.min.z));
}

void Run::writePage(unsigned frame, const KeptNumbers& numbers, std::span<const Kept> kept) {
  const std::uint64_t number = window_.begin + frame;
  progress_.phase("extract", last_);
  progress_.step(number);
  PrismPage page = prismPage(window_, info_.triangles, kept, numbers, frame, executor_);
  const std::uint64_t owned = numbers.count(frame) + (number + 1 == last_ ? numbers.count(frame + 1) : 0);
  const std::uint64_t bytes = page.tets.size() * sizeof(hypermesh::Tet) + owned * sizeof(Vec4f);
  page_memory_ = {};
  // The tetrahedra, the vertices and the page's bytes; if it is compressed, those once more.
  page_memory_ = memory_.reserve(bytes * (options_.page_codec == paged::Codec::kRaw ? 2 : 3),
                                 "the page of frame " + std::to_string(number));
  progress_.phase("measure", last_);
  progress_.step(number);
  const double error = measurePrisms(window_, page.tets, numbers, frame, length_, executor_);
  stats_.error_measured = std::max(stats_.error_measured, error);

  progress_.phase("write", last_);
  progress_.step(number);
  std::vector<Vec4f> vertices;
  numbers.appendVertices(window_, frame, vertices);
  if (number + 1 == last_) numbers.appendVertices(window_, frame + 1, vertices);
  const std::uint64_t end = numbers.begin(window_.steps + 1) - numbers.begin(frame);
  const std::vector<hypermesh::Run> runs = exchange::nameForeign(page.tets, owned, end, writer_.nextVertex());
  for (const Vec4f& v : vertices) bounds_.add(v);
  writer_.setPageErrors(error > 0 ? static_cast<float>(stats_.tolerance) : 0.0F,
                        std::nextafter(static_cast<float>(error), error > 0 ? HUGE_VALF : 0.0F));
  unwrap(writer_.addPage(vertices, runs, page.tets, page.bounds));
  stats_.vertices += owned;
  stats_.tets += page.tets.size();
}

void Run::buildWindow() {
  progress_.phase("fit", last_);
  progress_.step(window_.begin);
  float largest = 0;
  for (unsigned f = 0; f <= window_.steps; ++f) {
    for (std::size_t v = 0; v < used_.size(); ++v) {
      const Vec3f& p = window_.frames[f][v];
      if (used_[v] != 0) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  const double tolerance = stats_.tolerance + kF32Step * static_cast<double>(largest) * length_.most();
  const std::vector<Kept> kept = fitLifelines(window_, edges_, used_, length_, tolerance, executor_);
  const KeptNumbers numbers(window_, kept);
  if (numbers.begin(window_.steps + 1) >> 32 != 0) {
    throw Error(FaultCode::kBadInput, source_.frameName(window_.begin), "frame " + std::to_string(window_.begin),
                "a window keeps " + std::to_string(numbers.begin(window_.steps + 1)) +
                    " vertices, local indices can name 2^32 - 1",
                "give a smaller --linear-window, or cut the mesh into parts");
  }
  for (unsigned frame = 0; frame < window_.steps; ++frame) writePage(frame, numbers, kept);
}

// The box of the mesh with a margin, so that its spatial walls bound nothing.
void Run::finish() {
  const float extent = std::max({bounds_.max.x - bounds_.min.x, bounds_.max.y - bounds_.min.y,
                                 bounds_.max.z - bounds_.min.z, std::numeric_limits<float>::min()});
  const auto margin = [&](float at) {
    return static_cast<float>(kMargin * double{extent} + kF32Step * 2 * std::abs(double{at}));
  };
  Bounds4f domain = bounds_;
  for (float Vec4f::*axis : {&Vec4f::x, &Vec4f::y, &Vec4f::z}) {
    domain.min.*axis -= margin(domain.min.*axis);
    domain.max.*axis += margin(domain.max.*axis);
  }
  writer_.setDomain(domain);
  stats_.frames = info_.times.size();
  stats_.triangles = info_.triangles.size();
  stats_.tets_expanded = 3 * stats_.triangles * last_;
  stats_.input_xxh3 = digest_.value();
}

Stats Run::run() {
  const auto fixed = memory_.reserve(plan(source_, options_).fixed_bytes, "the frames of a window");
  lookAtSurface();
  const unsigned most = stepsOf(source_, options_);
  window_.frames.resize(most + std::size_t{1});
  progress_.phase("read", last_ + 1);
  read(0, window_.frames[0]);
  setTolerance();
  for (window_.begin = 0; window_.begin < last_; window_.begin += window_.steps) {
    if (window_.begin != 0) std::swap(window_.frames[0], window_.frames[window_.steps]);
    window_.steps = static_cast<unsigned>(std::min<std::uint64_t>(most, last_ - window_.begin));
    progress_.phase("read", last_ + 1);
    for (unsigned f = 1; f <= window_.steps; ++f) read(window_.begin + f, window_.frames[f]);
    buildWindow();
  }
  finish();
  return stats_;
}

}  // namespace

void checkSource(const exchange::SurfaceSource& source, const Options& options) {
  const exchange::SurfaceInfo& info = source.info();
  const auto bad = [&](const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kBadInput, source.frameName(0), "", what, remedy);
  };
  if (!std::isfinite(options.linear_tolerance) || options.linear_tolerance < 0) {
    throw Error(FaultCode::kUsage, "", "option --linear-tolerance", "is no length",
                "give 0, a length, or a part as 0.1%");
  }
  if (options.linear_window < 1 || options.linear_window > kMostSteps) {
    throw Error(FaultCode::kUsage, "", "option --linear-window", std::to_string(options.linear_window) + " steps",
                "give 1 to " + std::to_string(kMostSteps));
  }
  if (info.times.size() < 2) {
    bad(std::to_string(info.times.size()) + " frame; a hypermesh lies between frames and needs two at least",
        "give more frames");
  }
  if (info.times.size() - 1 > kMaxFrame) {
    bad(std::to_string(info.times.size()) + " frames; f32 frame numbers allow " + std::to_string(kMaxFrame + 1),
        "cut the sequence into parts");
  }
  if (info.triangles.empty()) bad("has no triangles", "give a mesh with faces");
}

hypermesh::MeshHeader meshHeader(const exchange::SurfaceSource& source) {
  hypermesh::MeshHeader header{};
  header.index_to_world = source.info().index_to_world;
  header.domain = {{0, 0, 0, 0}, {0, 0, 0, static_cast<float>(source.info().times.size() - 1)}};
  header.isovalue = std::numeric_limits<double>::quiet_NaN();
  return header;
}

Plan plan(const exchange::SurfaceSource& source, const Options& options) {
  checkSource(source, options);
  const exchange::SurfaceInfo& info = source.info();
  const unsigned steps = stepsOf(source, options);
  const std::uint64_t vertices = info.vertices, triangles = info.triangles.size(), slabs = info.times.size() - 1;
  Plan plan;
  // Positions as read and as placed (a file's text beside), masks twice with their marks, numbers, edges.
  plan.fixed_bytes = vertices * (sizeof(Vec3f) * (steps + std::uint64_t{1}) + 2 * sizeof(Kept) + 3) +
                     KeptNumbers::bytes(vertices, steps) + surfaceEdgesBytes(triangles);
  plan.most_page_bytes = 2 * (3 * triangles * sizeof(hypermesh::Tet) * (options.linear_window == 1 ? 1 : steps) +
                              2 * vertices * sizeof(Vec4f));
  const std::uint64_t windows = (slabs + steps - 1) / steps;
  const auto output = [&](std::uint64_t expanded) {
    return expanded * 3 * triangles * sizeof(hypermesh::Tet) +
           slabs * (container::kPageAlignment + sizeof(paged::PageEntry)) + info.times.size() * sizeof(double) +
           sizeof(hypermesh::MeshHeader);
  };
  plan.least_output_bytes = output(windows);
  plan.most_output_bytes = output(slabs) + (slabs + 1) * vertices * sizeof(Vec4f) + 4096;
  return plan;
}

Stats buildPrisms(exchange::SurfaceSource& source, hypermesh::Writer& writer, const Options& options,
                  outofcore::Executor& executor, outofcore::MemoryBudget& memory, outofcore::Progress& progress) {
  checkSource(source, options);
  return Run(source, writer, options, executor, memory, progress).run();
}

}  // namespace tet4d::prisms
