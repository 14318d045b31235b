#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "libpreprocess/error.h"
#include "tools/report/slice_errors.h"
#include "tools/report/stiff_cases.h"

namespace tet4d::report {
namespace {

// Slices taken back into cells, where the ball is a ball whatever the world is like.
void measureCase(const std::string& path, const StiffCase& one, cli::Session& session, Row& row) {
  const Ball& ball = one.ball;
  const auto mesh = unwrap(hypermesh::File::open(path));
  const double cells = static_cast<double>(ball.samples - 1), last = static_cast<double>(ball.frames - 1);
  for (const bool between : {false, true}) {
    SliceErrors errors;
    for (const double frame : {2.0, 5.0}) {
      const double part = (frame + (between ? 0.5 : 0)) / last;
      exchange::WorldMesh slice = sliceAt(mesh, part * one.time_unit);
      toCells(one, slice);
      auto centre = ball.centreAt(part);
      for (double& c : centre) c *= cells;
      const double radius = ball.radiusAt(part) * cells;
      const measure::OneWayDistance d = measure::distanceToSphere({slice.points, slice.triangles}, centre, radius,
                                                                  {1e-3, 50'000}, session.executor());
      errors.add(d.max, d.max_bound, d.p99, d.rms);
      const double area = 4 * 3.141592653589793 * radius * radius;
      const Size size = sizeOf(slice);
      errors.addSize(size.area / area - 1, 3 * size.volume / (area * radius) - 1);
    }
    errors.write(row, between ? "between" : "at", 1);
  }
}

void runCase(Bench& bench, const StiffCase& one) {
  const StiffInput input = writeCase(one, bench.work);
  std::vector<std::string> words = input.words;
  Row row = beginRow("stiff", input.name, input.digest, "tet4d-mc", words);
  row["case"] = one.what;
  row["value"] = one.value;
  if (bench.rows.take(row)) return;
  words.insert(words.end(), {"-o", "X.t4h", "-f", "-q", "--stats", "stats.json"});
  const ChildRun run = bench.programs.median("tet4d-mc", words, bench.work + "/stats.json", bench.repeat);
  addRun(row, run);
  if (run.record) {
    row["tets"] = run.record->count("tets");
    measureCase(bench.work + "/X.t4h", one, bench.session, row);
  }
  std::error_code ignored;
  std::filesystem::remove(bench.work + "/X.t4h", ignored);
  bench.rows.add(std::move(row));
}

}  // namespace

Section sweepStiff(Bench& bench) {
  Ball ball;
  ball.samples = bench.full ? 49 : 33;
  ball.frames = 9;
  const std::vector<StiffCase> cases = worldCases(ball, bench.full, 1e8);
  bench.session.progress().phase("stiff", cases.size());
  for (std::size_t k = 0; k < cases.size(); ++k) {
    runCase(bench, cases[k]);
    bench.session.progress().step(k + 1);
  }
  const Plot error = stiffPlot(bench.rows, "stiff", "rms_between",
                               {"stiff-error",
                                "error of stiff cases",
                                "value (see the legend)",
                                "rms distance between frames, cells",
                                true,
                                true,
                                {}});
  const Plot seconds = stiffPlot(
      bench.rows, "stiff", "seconds_wall",
      {"stiff-seconds", "run time of stiff cases", "value (see the legend)", "seconds (wall)", true, false, {}});
  return {
      "tet4d-mc: stiff cases",
      "The same ball with cells of an aspect ratio along z, an origin far away, times in another unit, and noise on "
      "the "
      "samples (in cells). Slices are taken back into cells and measured against the sphere: without noise the error "
      "should not move, with noise it should follow it.",
      {error, seconds},
      {"case", "value", "tets", "seconds_wall", "seconds_cpu", "peak_bytes", "rms_at", "max_at", "rms_between",
       "p99_between", "max_between", "area_error_between", "volume_error_between", "load"},
      "stiff"};
}

}  // namespace tet4d::report
