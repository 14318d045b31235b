#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "libpreprocess/error.h"
#include "libpreprocess/measure/picture_files.h"
#include "libpreprocess/outofcore/output_file.h"
#include "tools/report/stiff_cases.h"

namespace tet4d::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSweep = "stiff-dyntri";

// Along z onto all cells, without lights or walls: the same picture whatever the world is like, but for what noise
// does. An edge of a wall would lie on samples, where rounding decides.
void writeCamera(const StiffCase& one, const std::string& path) {
  const double cells = static_cast<double>(one.ball.samples - 1), middle = cells / 2;
  const double depth = one.aspect * cells;
  const Row camera{{"eye", {one.origin + middle, middle - one.origin, one.origin + 2 * depth}},
                   {"target", {one.origin + middle, middle - one.origin, one.origin + depth / 2}},
                   {"up", {0, 1, 0}},
                   {"ortho_height", 1.1 * cells},
                   {"lights", Row::array()},
                   {"ambient", {1, 1, 1}},
                   {"material", {{"color", {0.9, 0.6, 0.2}}, {"back_color", {0.9, 0.6, 0.2}}}},
                   {"background", {0, 0, 0}}};
  outofcore::OutputFile file(path, true);
  file.write(camera.dump());
  file.commit();
}

std::vector<std::string> picturesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const char* frame : {"00000", "00001", "00002"}) names.push_back(fmt::format("{}/{}.png", folder, frame));
  return names;
}

ChildRun draw(Bench& bench, const std::string& renderer, const std::string& folder) {
  std::error_code ignored;
  fs::remove_all(bench.work + "/" + folder, ignored);
  fs::create_directories(bench.work + "/" + folder, ignored);
  // Away from a frame, at one, and between two.
  return bench.programs.run(
      "tet4d-play",
      {"stiff.t4d", "--offscreen", "--renderer", renderer, "--size", "128x128", "--camera", "camera.json", "--samples",
       "4", "--times", "1.5f:4.5f:1.5f", "-o", folder + "/%05d.png", "-f", "-q", "--stats", "play.json"},
      bench.work + "/play.json");
}

double rmse255(Bench& bench, const std::string& a, const std::string& b) {
  measure::FilmMeter meter;
  measure::addFilm(picturesIn(bench.work + "/" + a), picturesIn(bench.work + "/" + b), meter);
  return 255 * meter.rmse();
}

// Builds and draws; false, with the row saying why, if a program fails.
bool makePictures(Bench& bench, const StiffCase& one, const StiffInput& input, const std::string& folder, Row& row) {
  std::vector<std::string> words = input.words;
  words.insert(words.end(), {"-o", "stiff.t4h", "-f", "-q"});
  const ChildRun mesh = bench.programs.run("tet4d-mc", words);
  if (mesh.exit_code != 0) {
    addRun(row, mesh);
    return false;
  }
  const ChildRun built =
      bench.programs.median("dyntri-build", {"stiff.t4h", "-o", "stiff.t4d", "-f", "-q", "--stats", "stats.json"},
                            bench.work + "/stats.json", bench.repeat);
  addRun(row, built);
  if (!built.record) return false;
  row["tets"] = built.record->count("tets");
  row["file_bytes"] = fs::file_size(bench.work + "/stiff.t4d");
  writeCamera(one, bench.work + "/camera.json");
  const ChildRun pictures = draw(bench, "cpu", folder);
  if (!pictures.record) {
    row["exit"] = pictures.exit_code;
    row["fault"] = pictures.fault;
    return false;
  }
  std::vector<double> ms;
  for (const auto& frame : pictures.record->frames) ms.push_back(frame.ms);
  row["ms_p50"] = number(measure::percentile(ms, 0.5));
  return true;
}

void runCase(Bench& bench, const StiffCase& one) {
  const StiffInput input = writeCase(one, bench.work);
  Row row = beginRow(kSweep, input.name, input.digest, "dyntri-build", input.words);
  row["case"] = one.what;
  row["value"] = one.value;
  if (bench.rows.take(row)) return;
  if (makePictures(bench, one, input, "pictures", row)) {
    row["rmse_255"] = number(rmse255(bench, "pictures", "plain"));
    // A build without OpenGL has one renderer.
    const ChildRun other = draw(bench, "gl", "other");
    if (other.exit_code == 0)
      row["renderers_apart_255"] = number(rmse255(bench, "pictures", "other"));
    else
      row["absent"] = "second renderer: " + other.fault;
  }
  bench.rows.add(std::move(row));
}

}  // namespace

Section sweepStiffTriangles(Bench& bench) {
  Ball ball;
  ball.samples = bench.full ? 49 : 33;
  ball.frames = 9;
  const StiffCase plain{"plain", 1, ball, 1, 0, 1};
  Row row;
  if (!makePictures(bench, plain, writeCase(plain, bench.work), "plain", row))
    throw Error(FaultCode::kBadInput, "", "the ball of unit cells", "is not drawn: " + row.value("fault", ""), "");
  const std::vector<StiffCase> cases = worldCases(ball, bench.full, 1e8);
  bench.session.progress().phase("stiff", cases.size());
  for (std::size_t k = 0; k < cases.size(); ++k) {
    runCase(bench, cases[k]);
    bench.session.progress().step(k + 1);
  }
  const Plot error = stiffPlot(bench.rows, kSweep, "rmse_255",
                               {"stiff-dyntri-error",
                                "pictures of stiff cases against those of unit cells",
                                "value (see the legend)",
                                "RMSE, 255ths",
                                true,
                                false,
                                {}});
  const Plot seconds = stiffPlot(bench.rows, kSweep, "seconds_wall",
                                 {"stiff-dyntri-seconds",
                                  "run time of dyntri-build on stiff cases",
                                  "value (see the legend)",
                                  "seconds (wall)",
                                  true,
                                  false,
                                  {}});
  return {
      "dyntri-build and tet4d-play: stiff cases",
      "The ball of the stiff cases as dynamic triangles, drawn along z without lights, so that cells of an aspect "
      "ratio "
      "along z, an origin far away and times in another unit should give the pictures of unit cells: their RMSE in "
      "linear light, 255ths; noise should move them as it moves the surface. Renderers apart: pictures of plain C++ "
      "against those of OpenGL.",
      {error, seconds},
      {"case", "value", "tets", "file_bytes", "seconds_wall", "seconds_cpu", "peak_bytes", "ms_p50", "rmse_255",
       "renderers_apart_255", "load", "absent"},
      kSweep};
}

}  // namespace tet4d::report
