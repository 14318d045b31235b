#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "formats/hypermesh.h"
#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/report/slim_run.h"
#include "tools/report/stiff_cases.h"

namespace tet4d::report {
namespace {

constexpr std::size_t kLayers = 5;
constexpr const char* kSweep = "stiff-qslim";

// What tet4d-mc makes into the hypermesh of a case.
struct SlimCase {
  std::string what;
  double value = 0;
  StiffInput input;
};

// A ball that crosses the cube at a speed, cells a frame, and keeps its size.
StiffCase movingBall(Ball ball, double speed) {
  const double last = static_cast<double>(ball.frames - 1), cells = static_cast<double>(ball.samples - 1);
  constexpr std::array<double, 3> kDirection{0.6202, 0.5503, -0.5590};
  ball.radius = 0.16;
  ball.growth = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    ball.velocity[c] = kDirection[c] * speed * last / cells;
    ball.centre[c] = 0.503 + 0.011 * static_cast<double>(c) - 0.5 * ball.velocity[c];
  }
  return {"cells a frame", speed, ball, 1, 0, 1};
}

// A plane at rest: one flat piece of space-time, of n x n cells and all frames.
StiffInput flatInput(std::size_t n, std::size_t frames, const std::string& work) {
  StiffInput input{fmt::format("plane of {}^2 x {}", n, frames), {}, {}};
  const std::string file = fmt::format("plane-{}-{}.f32", n, frames);
  outofcore::OutputFile out(work + "/" + file, true);
  std::vector<float> layer(n * n);
  for (std::size_t k = 0; k < frames * kLayers; ++k) {
    std::fill(layer.begin(), layer.end(), static_cast<float>(k % kLayers) - 2.375F);
    out.write(std::as_bytes(std::span(layer)));
  }
  out.commit();
  input.digest = digestOf({work + "/" + file});
  input.words = {file, "--size", fmt::format("{0},{0},{1}", n, kLayers), "--type", "f32", "--iso", "0"};
  return input;
}

std::vector<SlimCase> casesOf(Bench& bench) {
  Ball ball;
  ball.samples = bench.full ? 49 : 25;
  ball.frames = bench.full ? 9 : 7;
  std::vector<SlimCase> cases;
  const auto addBall = [&](const StiffCase& one) {
    cases.push_back({one.what, one.value, writeCase(one, bench.work)});
  };
  for (const StiffCase& one : worldCases(ball, bench.full, 1e7)) addBall(one);
  const std::vector<double> speeds =
      bench.full ? std::vector<double>{0, 0.02, 0.05, 0.2, 0.5, 1, 2, 5} : std::vector<double>{0, 0.02, 1};
  for (const double speed : speeds) addBall(movingBall(ball, speed));
  // Flat and curved pieces of like numbers of tetrahedra: seconds a tetrahedron should not grow, nor differ much.
  const std::vector<std::size_t> flat =
      bench.full ? std::vector<std::size_t>{33, 65, 129, 257} : std::vector<std::size_t>{17, 33};
  for (const std::size_t n : flat)
    cases.push_back({"flat piece", static_cast<double>(n), flatInput(n, ball.frames, bench.work)});
  const std::vector<std::size_t> curved =
      bench.full ? std::vector<std::size_t>{25, 49, 97, 193} : std::vector<std::size_t>{17, 25};
  for (const std::size_t n : curved) {
    StiffCase one{"curved piece", static_cast<double>(n), ball, 1, 0, 1};
    one.ball.samples = n;
    addBall(one);
  }
  return cases;
}

struct Way {
  std::string order, metric;
};

void runWay(Bench& bench, const SlimCase& one, const Way& way) {
  const std::vector<std::string> words{"stiff.t4h", "--ratio", "0.1", "--order", way.order, "--metric", way.metric};
  Row row = beginRow(kSweep, one.input.name, one.input.digest, "hyper-qslim", words);
  row["case"] = fmt::format("{} {}", one.what, one.value);
  if (bench.rows.take(row)) return;
  const std::string path = bench.work + "/stiff.t4h";
  std::vector<std::string> made = one.input.words;
  made.insert(made.end(), {"-o", path, "-f", "-q"});
  row["series"] = way.order == "passes" && way.metric == "slice"
                      ? one.what
                      : fmt::format("{}, {}, {}", one.what, way.order, way.metric);
  row["order"] = way.order;
  row["metric"] = way.metric;
  row["value"] = one.value;
  if (const ChildRun run = bench.programs.run("tet4d-mc", made); run.exit_code != 0) {
    addRun(row, run);
    bench.rows.add(std::move(row));
    return;
  }
  {
    const auto mesh = unwrap(hypermesh::File::open(path));
    const auto& low = mesh.header().domain.min;
    row["tets_in"] = mesh.header().tets;
    // Cells are the unit, whatever the world is like: slices stay in index space.
    measure::SliceJudge judge(measure::slicesOf(mesh), measure::sampleTimes(mesh.header().domain, 2),
                              {{}, {low.x, low.y, low.z}}, {1e-2, 10'000, 300'000});
    runSlim(bench, words, judge, 1, row);
    if (row.contains("seconds_simplify"))
      row["us_per_tet"] = number(1e6 * row["seconds_simplify"].get<double>() / static_cast<double>(mesh.header().tets));
  }
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  bench.rows.add(std::move(row));
}

// Seconds a tetrahedron over tetrahedra, of the pieces that grow.
Plot growthPlot(const Rows& rows) {
  Plot plot{"stiff-qslim-growth", "run time of growing pieces", "tetrahedra", "us to simplify one", true, true, {}};
  for (const Row& row : rows.all()) {
    if (row.at("sweep") != kSweep || !row.contains("us_per_tet")) continue;
    const std::string name = row.value("series", "");
    if (name != "flat piece" && name != "curved piece") continue;
    if (plot.series.empty() || plot.series.back().name != name) plot.series.push_back({name, {}});
    plot.series.back().points.push_back({row.at("tets_in").get<double>(), row.at("us_per_tet").get<double>(), ""});
  }
  return plot;
}

}  // namespace

Section sweepStiffSlim(Bench& bench) {
  const std::vector<SlimCase> cases = casesOf(bench);
  std::vector<Way> ways{{"passes", "slice"}};
  if (bench.full) ways.insert(ways.end(), {{"multichoice", "slice"}, {"heap", "slice"}, {"passes", "paper"}});
  for (const Way& way : ways) {
    for (const SlimCase& one : cases) runWay(bench, one, way);
  }
  Plot error = stiffPlot(bench.rows, kSweep, "rms_between",
                         {"stiff-qslim-error",
                          "error of stiff cases, to a tenth",
                          "value (see the legend)",
                          "rms distance between frames, cells",
                          true,
                          true,
                          {}});
  // Of the default way: the others are in the table. Pieces that grow have a plot of their own.
  std::erase_if(error.series, [](const Series& s) {
    return s.name.find(',') != std::string::npos || s.name.find("piece") != std::string::npos;
  });
  return {
      "hyper-qslim: stiff cases",
      "To a tenth of the tetrahedra: the ball with cells of an aspect ratio along z, far origins, other units of time, "
      "noise (cells), at rest and at speeds up to 5 cells a frame; a plane at rest, which is flat in space-time, and "
      "balls, of growing size. Slices of the result against those of the input, in cells. Neither shape of cells, "
      "origin nor unit of time should move the error; time for a tetrahedron should not grow with the size of a flat "
      "piece.",
      {error, growthPlot(bench.rows)},
      {"case", "order", "metric", "tets_in", "tets", "collapses", "seconds_work", "us_per_tet", "peak_bytes", "rms_at",
       "p99_at", "max_at", "rms_between", "p99_between", "max_between", "volume_error_at", "volume_error_between",
       "load"},
      kSweep};
}

}  // namespace tet4d::report
