#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>

#include "formats/container.h"
#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/report/peer.h"
#include "tools/report/slice_errors.h"
#include "tools/report/sweeps.h"

namespace tet4d::report {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kColumns{"program",
                                        "space_stride",
                                        "time_stride",
                                        "samples",
                                        "tets",
                                        "triangles",
                                        "seconds_wall",
                                        "seconds_cpu",
                                        "samples_per_second",
                                        "peak_bytes",
                                        "rms_at_cells",
                                        "p99_at_cells",
                                        "max_at_cells",
                                        "rms_between_cells",
                                        "p99_between_cells",
                                        "max_between_cells",
                                        "max_bound_between_cells",
                                        "rms_between",
                                        "area_error_at",
                                        "area_error_between",
                                        "volume_error_at",
                                        "volume_error_between",
                                        "load",
                                        "absent"};

// The strides of a sweep, and the frames measured at and between.
struct Strides {
  std::vector<std::size_t> space, time;
  // Frames of the input every time stride keeps, inner ones first; of `frames`.
  std::vector<double> at(std::size_t frames) const {
    const std::size_t step = time.back();
    std::vector<double> result;
    for (std::size_t k = 0; k < frames && result.size() < 3; k += step) {
      if (k > 0 && k + 1 < frames) result.push_back(static_cast<double>(k));
    }
    if (result.empty()) result.push_back(0);
    return result;
  }
  // Halfway between two frames that a stride keeps, near those.
  std::vector<double> between(std::size_t frames, std::size_t stride) const {
    std::vector<double> result;
    for (const double k : at(frames)) {
      const double half = k + static_cast<double>(stride) / 2;
      if (half < static_cast<double>(frames - 1)) result.push_back(half);
    }
    return result;
  }
};

Strides stridesOf(bool full) {
  if (full) return {{1, 2, 3, 4, 6, 8, 12, 16}, {1, 2, 4, 8}};
  return {{1, 2, 4, 8}, {1, 2, 4}};
}

// What measures a hypermesh file: adds figures of slices at times, given in frames of the whole input.
using Judge = std::function<void(const hypermesh::File&, double frame, SliceErrors&)>;

struct Job {
  std::string sweep, input, digest;
  std::vector<std::string> words;  // of tet4d-mc, but for strides and outputs
  std::size_t frames = 0;
  double cell = 1;  // world
  Judge judge;
};

void measureFile(const std::string& path, const Job& job, const Strides& strides, std::size_t stride, Row& row) {
  const auto mesh = unwrap(hypermesh::File::open(path));
  SliceErrors at, between;
  for (const double frame : strides.at(job.frames)) job.judge(mesh, frame, at);
  for (const double frame : strides.between(job.frames, stride)) job.judge(mesh, frame, between);
  at.write(row, "at", job.cell);
  between.write(row, "between", job.cell);
}

// One row: a run of tet4d-mc, and its slices measured.
void runOne(Bench& bench, const Job& job, const Strides& strides, std::size_t space, std::size_t time) {
  std::vector<std::string> words = job.words;
  if (space > 1) words.insert(words.end(), {"--stride", std::to_string(space)});
  if (time > 1) words.insert(words.end(), {"--time-stride", std::to_string(time)});
  Row row = beginRow(job.sweep, job.input, job.digest, "tet4d-mc", words);
  if (bench.rows.take(row)) return;
  words.insert(words.end(), {"-o", "X.t4h", "-f", "-q", "--stats", "stats.json"});
  const ChildRun run = bench.programs.median("tet4d-mc", words, bench.work + "/stats.json", bench.repeat);
  row["space_stride"] = space;
  row["time_stride"] = time;
  addRun(row, run);
  if (run.record) {
    row["tets"] = run.record->count("tets");
    row["samples"] = run.record->count("voxels");
    row["samples_per_second"] = number(static_cast<double>(run.record->count("voxels")) / run.seconds_wall);
    measureFile(bench.work + "/X.t4h", job, strides, time, row);
  }
  std::error_code ignored;
  fs::remove(bench.work + "/X.t4h", ignored);
  bench.rows.add(std::move(row));
}

// The surfaces of a frame each that VTK makes of the ball at a stride: between frames a sequence of them shows the one
// before.
void runPeerOnBall(Bench& bench, const Ball& ball, const Job& job, const Strides& strides, std::size_t space) {
  Ball coarse = ball;
  coarse.samples = (ball.samples - 1) / space + 1;
  if ((coarse.samples - 1) * space + 1 != ball.samples) return;
  const std::string name = fmt::format("ball-{}.f32", space);
  std::vector<std::string> words{"isosurfaces", name, std::to_string(coarse.samples), "0", "surface"};
  std::vector<std::pair<double, std::size_t>> wanted;  // the time measured, the frame shown
  for (const double frame : strides.at(ball.frames)) wanted.emplace_back(frame, static_cast<std::size_t>(frame));
  const std::size_t at = wanted.size();
  for (const double frame : strides.between(ball.frames, 1))
    wanted.emplace_back(frame, static_cast<std::size_t>(std::floor(frame)));
  for (const auto& [time, shown] : wanted) words.push_back(std::to_string(shown));
  Row row = beginRow("ball", job.input, job.digest, "vtkFlyingEdges3D", words);
  if (bench.rows.take(row)) return;
  coarse.write(bench.work + "/" + name);
  const PeerRun run = runPeer(bench.programs, words);
  row["space_stride"] = space;
  row["time_stride"] = 1;
  addPeer(row, run);
  if (run.absent.empty() && run.child.exit_code == 0) {
    const double step = 1 / static_cast<double>(coarse.samples - 1), last = static_cast<double>(ball.frames - 1);
    row["samples"] = coarse.samples * coarse.samples * coarse.samples * ball.frames;
    row["triangles"] = run.number("triangles");
    SliceErrors errors[2];
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const double time = wanted[k].first / last;
      const PeerSurface surface = readPeerSurface(fmt::format("{}/surface-{}", bench.work, wanted[k].second), step);
      const measure::OneWayDistance d =
          measure::distanceToSphere({surface.points, surface.triangles}, ball.centreAt(time), ball.radiusAt(time),
                                    {1e-4 * job.cell, 50'000}, bench.session.executor());
      errors[k < at ? 0 : 1].add(d.max, d.max_bound, d.p99, d.rms);
    }
    errors[0].writeLengths(row, "at", job.cell);
    errors[1].writeLengths(row, "between", job.cell);
  }
  row["load"] = loadAverage();
  std::error_code ignored;
  fs::remove(bench.work + "/" + name, ignored);
  bench.rows.add(std::move(row));
}

// Error against seconds (of CPU: those of a clock are the machine's as much as ours), against the grid step, and
// between frames against seconds: a line a time stride.
std::vector<Plot> plotsOf(const Rows& rows, const std::string& sweep) {
  Plot time{sweep + "-error-seconds",
            "error between frames against run time",
            "seconds of CPU, whole program",
            "rms distance, cells of the finest grid",
            true,
            true,
            {}};
  Plot step{sweep + "-error-stride",
            "error at frames against the grid step",
            "stride in space",
            "rms distance, cells of the finest grid",
            true,
            true,
            {}};
  std::map<std::string, std::pair<Series, Series>> by_name;
  for (const Row& row : rows.all()) {
    if (row.at("sweep") != sweep || !row.contains("rms_at_cells")) continue;
    const auto stride = row.at("time_stride").get<std::size_t>();
    const bool ours = row.at("program") == "tet4d-mc";
    const std::string name = ours ? fmt::format("time stride {}", stride) : "VTK, a surface a frame";
    auto& [first, second] = by_name[name];
    first.name = second.name = name;
    const auto value = [&](const char* key) { return row.at(key).is_number() ? row.at(key).get<double>() : 0; };
    const std::string label = stride == 1 && ours ? fmt::format("1/{}", row.at("space_stride").get<std::size_t>()) : "";
    first.points.push_back({value("seconds_cpu"), value("rms_between_cells"), label});
    second.points.push_back({value("space_stride"), value("rms_at_cells"), ""});
  }
  for (auto& [series, both] : by_name) {
    time.series.push_back(std::move(both.first));
    step.series.push_back(std::move(both.second));
  }
  return {time, step};
}

void runAll(Bench& bench, const Job& job, const Strides& strides) {
  bench.session.progress().phase(job.sweep, strides.space.size() * strides.time.size());
  std::uint64_t done = 0;
  for (const std::size_t time : strides.time) {
    for (const std::size_t space : strides.space) {
      runOne(bench, job, strides, space, time);
      bench.session.progress().step(++done);
    }
  }
}

}  // namespace

Section sweepBall(Bench& bench) {
  Ball ball;
  if (bench.full) ball.samples = 129, ball.frames = 33;  // fine strides take tenths of seconds
  const double step = 1 / static_cast<double>(ball.samples - 1), last = static_cast<double>(ball.frames - 1);
  ball.write(bench.work + "/ball.f32");
  std::string times;
  for (std::size_t k = 0; k < ball.frames; ++k) times += fmt::format("{}\n", static_cast<double>(k) / last);
  outofcore::OutputFile file(bench.work + "/ball-times.txt", true);
  file.write(times);
  file.commit();
  const std::string n = std::to_string(ball.samples);
  Job job{"ball",
          fmt::format("ball of {0}^3 x {1}", n, ball.frames),
          digestOf({bench.work + "/ball.f32"}),
          {"ball.f32", "--size", fmt::format("{0},{0},{0}", n), "--type", "f32", "--spacing", fmt::format("{}", step),
           "--times", "ball-times.txt", "--iso", "0"},
          ball.frames,
          step,
          {}};
  job.judge = [&](const hypermesh::File& mesh, double frame, SliceErrors& errors) {
    const double time = frame / last, radius = ball.radiusAt(time);
    const exchange::WorldMesh slice = sliceAt(mesh, time);
    const measure::OneWayDistance d = measure::distanceToSphere(
        {slice.points, slice.triangles}, ball.centreAt(time), radius, {1e-4 * step, 50'000}, bench.session.executor());
    errors.add(d.max, d.max_bound, d.p99, d.rms);
    const Size size = sizeOf(slice);
    const double area = 4 * std::numbers::pi * radius * radius;
    errors.addSize(size.area / area - 1, 3 * size.volume / (area * radius) - 1);
  };
  const Strides strides = stridesOf(bench.full);
  runAll(bench, job, strides);
  for (const std::size_t space : bench.peer ? strides.space : std::vector<std::size_t>{})
    runPeerOnBall(bench, ball, job, strides, space);
  return {
      "tet4d-mc: a ball that moves and grows",
      "Slices of the hypermesh against the sphere they should be, in closed form: the distance of the slice's "
      "points to "
      "the sphere at frames that every time stride keeps, and halfway between two kept frames; areas and volumes "
      "relative to the sphere's. Cells are those of the finest grid. Second order is a slope of two in the second "
      "plot. VTK's rows are a surface a frame by its flying edges, seconds of the filter alone; between frames such a "
      "sequence shows the surface of the frame before.",
      plotsOf(bench.rows, "ball"), kColumns, "ball"};
}

Section sweepFrames(Bench& bench, const std::vector<std::string>& inputs, const std::string& iso) {
  std::vector<std::string> files, words;
  for (const std::string& input : inputs) {
    const std::string path = fs::absolute(input).string();
    words.push_back(path);
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file() && entry.path().extension() != ".md") files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  words.insert(words.end(), {"--iso", iso});
  const std::string name = fs::path(inputs.front()).filename().empty()
                               ? fs::path(inputs.front()).parent_path().filename()
                               : fs::path(inputs.front()).filename();
  // The reference: all frames, all samples.
  std::vector<std::string> reference_words = words;
  reference_words.insert(reference_words.end(), {"-o", "exact.t4h", "-f", "-q", "--stats", "stats.json"});
  const ChildRun run = bench.programs.run("tet4d-mc", reference_words, bench.work + "/stats.json");
  if (run.exit_code != 0)
    throw Error(FaultCode::kBadInput, inputs.front(), "", "tet4d-mc fails on it: " + run.fault, "");
  const auto exact = unwrap(hypermesh::File::open(bench.work + "/exact.t4h"));
  const AffineMap& map = exact.header().index_to_world;
  const double cell = std::cbrt(std::abs(cellVolume(map)));
  std::map<double, exchange::WorldMesh> slices;  // of the reference, by frame
  Job job{"frames", name, digestOf(files), words, exact.times().size(), cell, {}};
  job.judge = [&](const hypermesh::File& mesh, double frame, SliceErrors& errors) {
    const double time = timeOfFrame(exact.times(), frame);
    if (time > mesh.times().back()) return;  // the stride leaves the end out
    if (!slices.contains(frame)) slices.emplace(frame, sliceAt(exact, time));
    const exchange::WorldMesh &reference = slices.at(frame), slice = sliceAt(mesh, time);
    const measure::SurfaceDistance d =
        measure::surfaceDistance({slice.points, slice.triangles}, {reference.points, reference.triangles},
                                 {1e-2 * cell, 30'000, 1'000'000}, bench.session.executor());
    errors.add(d.max(), d.maxBound(), d.p99(), d.rms());
    const Size size = sizeOf(slice), whole = sizeOf(reference);
    errors.addSize(size.area / whole.area - 1, size.closed && whole.closed ? size.volume / whole.volume - 1 : 0);
  };
  runAll(bench, job, stridesOf(bench.full));
  std::error_code ignored;
  fs::remove(bench.work + "/exact.t4h", ignored);
  return {
      "tet4d-mc: " + name,
      "Slices against those of the hypermesh of all samples and frames, in both directions (the worse counts): at "
      "frames "
      "that every time stride keeps, and halfway between two kept frames. A surface that ends at the walls ends where "
      "the strided grid does, which is what the largest distances show. Volumes are left out (0) where slices are "
      "open. "
      "The row of stride 1 in both is the reference itself.",
      plotsOf(bench.rows, "frames"), kColumns, "frames"};
}

std::string digestOf(const std::vector<std::string>& files) {
  if (files.size() == 1) return cli::fileDigest(files.front());
  std::string all;
  for (const std::string& file : files) all += cli::fileDigest(file);
  return fmt::format("{:016x}", container::xxh3(std::as_bytes(std::span(all))));
}

}  // namespace tet4d::report
