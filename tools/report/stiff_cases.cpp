#include "tools/report/stiff_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace tet4d::report {

std::vector<StiffCase> worldCases(const Ball& ball, bool full, double farthest) {
  std::vector<StiffCase> cases;
  const std::vector<double> aspects =
      full ? std::vector<double>{1, 10, 1e2, 1e3, 1e4, 1e5, 1e6} : std::vector<double>{1, 1e3, 1e6};
  std::vector<double> origins = full ? std::vector<double>{0, 1, 1e2, 1e4, 1e6, 1e7} : std::vector<double>{1, 1e4};
  if (farthest > origins.back()) origins.push_back(farthest);
  const std::vector<double> units =
      full ? std::vector<double>{1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9} : std::vector<double>{1e-9, 1, 1e9};
  const std::vector<double> noises =
      full ? std::vector<double>{0.001, 0.01, 0.03, 0.1, 0.3, 1} : std::vector<double>{0.01, 0.1, 1};
  for (const double a : aspects) cases.push_back({"aspect ratio", a, ball, a, 0, 1});
  for (const double o : origins) cases.push_back({"far origin", o, ball, 1, o, 1});
  for (const double u : units) cases.push_back({"unit of time", u, ball, 1, 0, u});
  for (const double n : noises) {
    cases.push_back({"noise", n, ball, 1, 0, 1});
    cases.back().ball.noise = n;
  }
  return cases;
}

StiffInput writeCase(const StiffCase& one, const std::string& work) {
  const Ball& ball = one.ball;
  StiffInput input{fmt::format("ball of {}^3 x {}", ball.samples, ball.frames), {}, {}};
  // The field is a distance in the unit cube: noise and isovalue scale with it, cells are counted afterwards.
  const std::string file = fmt::format("ball-{}-{}-{}-{}.f32", ball.samples, ball.frames, ball.noise, ball.velocity[0]);
  const std::string path = work + "/" + file;
  if (!std::filesystem::exists(path)) ball.write(path);
  input.digest = digestOf({path});
  std::string times;
  for (std::size_t k = 0; k < ball.frames; ++k) {
    times += fmt::format("{}{}", k > 0 ? "," : "",
                         one.time_unit * static_cast<double>(k) / static_cast<double>(ball.frames - 1));
  }
  input.words = {file,
                 "--size",
                 fmt::format("{0},{0},{0}", ball.samples),
                 "--type",
                 "f32",
                 "--spacing",
                 fmt::format("1,1,{}", one.aspect),
                 fmt::format("--origin={0},{1},{0}", one.origin, -one.origin),
                 "--times",
                 times,
                 "--iso",
                 "0"};
  return input;
}

void toCells(const StiffCase& one, exchange::WorldMesh& slice) {
  for (auto& p : slice.points) p = {p[0] - one.origin, p[1] + one.origin, (p[2] - one.origin) / one.aspect};
}

Plot stiffPlot(const Rows& rows, const std::string& sweep, const std::string& column, Plot plot) {
  for (const Row& row : rows.all()) {
    if (row.at("sweep") != sweep || !row.contains(column) || !row.at(column).is_number()) continue;
    const std::string name = row.value("series", row.value("case", ""));
    auto found = std::find_if(plot.series.begin(), plot.series.end(), [&](const Series& s) { return s.name == name; });
    if (found == plot.series.end()) found = plot.series.insert(plot.series.end(), {name, {}});
    found->points.push_back({row.at("value").get<double>(), row.at(column).get<double>(), ""});
  }
  return plot;
}

}  // namespace tet4d::report
