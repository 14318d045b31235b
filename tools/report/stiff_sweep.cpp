#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "libpreprocess/error.h"
#include "tools/report/slice_errors.h"
#include "tools/report/sweeps.h"

namespace tet4d::report {
namespace {

// How the ball of unit cells is placed in the world, and what is done to its samples.
struct Case {
  std::string what;
  double value = 0;
  double aspect = 1, origin = 0, time_unit = 1, noise = 0;
};

std::vector<Case> casesOf(bool full) {
  std::vector<Case> cases;
  const std::vector<double> aspects =
      full ? std::vector<double>{1, 10, 1e2, 1e3, 1e4, 1e5, 1e6} : std::vector<double>{1, 1e3, 1e6};
  const std::vector<double> origins =
      full ? std::vector<double>{0, 1, 1e2, 1e4, 1e6, 1e7, 1e8} : std::vector<double>{1, 1e4, 1e8};
  const std::vector<double> units =
      full ? std::vector<double>{1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9} : std::vector<double>{1e-9, 1, 1e9};
  const std::vector<double> noises =
      full ? std::vector<double>{0.001, 0.01, 0.03, 0.1, 0.3, 1} : std::vector<double>{0.01, 0.1, 1};
  for (const double a : aspects) cases.push_back({"aspect ratio", a, a, 0, 1, 0});
  for (const double o : origins) cases.push_back({"far origin", o, 1, o, 1, 0});
  for (const double u : units) cases.push_back({"unit of time", u, 1, 0, u, 0});
  for (const double n : noises) cases.push_back({"noise", n, 1, 0, 1, n});
  return cases;
}

// Slices taken back into cells, where the ball is a ball whatever the world is like.
void measureCase(const std::string& path, const Ball& ball, const Case& one, cli::Session& session, Row& row) {
  const auto mesh = unwrap(hypermesh::File::open(path));
  const double cells = static_cast<double>(ball.samples - 1), last = static_cast<double>(ball.frames - 1);
  for (const bool between : {false, true}) {
    SliceErrors errors;
    for (const double frame : {2.0, 5.0}) {
      const double part = (frame + (between ? 0.5 : 0)) / last;
      exchange::WorldMesh slice = sliceAt(mesh, part * one.time_unit);
      for (auto& p : slice.points) {
        p = {p[0] - one.origin, p[1] + one.origin, (p[2] - one.origin) / one.aspect};
      }
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

void runCase(Bench& bench, const Ball& ball, const Case& one) {
  const std::string name = one.noise > 0 ? fmt::format("noise-{}.f32", one.noise) : "stiff-ball.f32";
  Ball sampled = ball;
  sampled.noise = one.noise;
  const std::string path = bench.work + "/" + name;
  if (!std::filesystem::exists(path)) sampled.write(path);
  std::string times;
  for (std::size_t k = 0; k < ball.frames; ++k) {
    times += fmt::format("{}{}", k > 0 ? "," : "",
                         one.time_unit * static_cast<double>(k) / static_cast<double>(ball.frames - 1));
  }
  const std::string n = std::to_string(ball.samples);
  std::vector<std::string> words{name,
                                 "--size",
                                 fmt::format("{0},{0},{0}", n),
                                 "--type",
                                 "f32",
                                 "--spacing",
                                 fmt::format("1,1,{}", one.aspect),
                                 fmt::format("--origin={0},{1},{0}", one.origin, -one.origin),
                                 "--times",
                                 times,
                                 "--iso",
                                 "0"};
  Row row = beginRow("stiff", fmt::format("ball of {}^3 x {}", n, ball.frames), digestOf({path}), "tet4d-mc", words);
  row["case"] = one.what;
  row["value"] = one.value;
  if (const Row* earlier = bench.rows.find(row)) {
    bench.rows.add(*earlier);
    return;
  }
  words.insert(words.end(), {"-o", "X.t4h", "-f", "-q", "--stats", "stats.json"});
  const ChildRun run = bench.programs.median("tet4d-mc", words, bench.work + "/stats.json", bench.repeat);
  addRun(row, run);
  if (run.record) {
    row["tets"] = run.record->count("tets");
    measureCase(bench.work + "/X.t4h", ball, one, bench.session, row);
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
  // The field is a distance in the unit cube: noise and isovalue scale with it, cells are counted afterwards.
  const std::vector<Case> cases = casesOf(bench.full);
  bench.session.progress().phase("stiff", cases.size());
  Plot error{"stiff-error",
             "error of stiff cases",
             "value (see the legend)",
             "rms distance between frames, cells",
             true,
             true,
             {}};
  Plot seconds{"stiff-seconds", "run time of stiff cases", "value (see the legend)", "seconds (wall)", true, false, {}};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    runCase(bench, ball, cases[k]);
    bench.session.progress().step(k + 1);
    const Row& row = bench.rows.all().back();
    if (error.series.empty() || error.series.back().name != cases[k].what) {
      error.series.push_back({cases[k].what, {}});
      seconds.series.push_back({cases[k].what, {}});
    }
    if (!row.contains("rms_between") || !row.at("rms_between").is_number()) continue;
    error.series.back().points.push_back({cases[k].value, row.at("rms_between").get<double>(), ""});
    seconds.series.back().points.push_back({cases[k].value, row.at("seconds_wall").get<double>(), ""});
  }
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
