#include "tools/report/views.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libpreprocess/error.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::report {
namespace {

using Vec = std::array<double, 3>;

// Towards the eye; corners of a cube are as far from its middle as faces here.
std::vector<Vec> cubeDirections() {
  std::vector<Vec> all{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const double c = 1 / std::sqrt(3.0);
  for (int k = 0; k < 8; ++k) all.push_back({(k & 1) != 0 ? c : -c, (k & 2) != 0 ? c : -c, (k & 4) != 0 ? c : -c});
  return all;
}

}  // namespace

std::vector<std::string> writeCubeViews(const Programs& programs, const std::string& input, const std::string& camera,
                                        const std::vector<std::string>& words) {
  std::vector<std::string> all{input,         "--offscreen", "--at",       "0f", "--write-camera",
                               "fitted.json", "-o",          "fitted.png", "-f", "-q"};
  all.insert(all.end(), words.begin(), words.end());
  if (!camera.empty()) all.insert(all.end(), {"--camera", camera});
  const ChildRun run = programs.run("tet4d-play", all);
  if (run.exit_code != 0) throw Error(FaultCode::kBadInput, input, "", "cannot be drawn: " + run.fault, "");
  std::ifstream file(programs.work() + "/fitted.json");
  const auto fitted = nlohmann::ordered_json::parse(file, nullptr, false);
  if (!fitted.is_object() || !fitted.contains("eye") || !fitted.contains("target")) {
    throw Error(FaultCode::kBadInput, input, "", "tet4d-play wrote no camera that can be read", "give --views one");
  }
  const auto eye = fitted.at("eye").get<Vec>(), target = fitted.at("target").get<Vec>();
  const double distance = std::hypot(eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]);
  std::vector<std::string> names;
  for (const Vec& d : cubeDirections()) {
    auto view = fitted;
    view["eye"] = Vec{target[0] + distance * d[0], target[1] + distance * d[1], target[2] + distance * d[2]};
    view["up"] = d[2] * d[2] > 0.5 ? Vec{0, 1, 0} : Vec{0, 0, 1};
    names.push_back(fmt::format("view-{:02}.json", names.size()));
    outofcore::OutputFile out(programs.work() + "/" + names.back(), true);
    out.write(view.dump(2) + "\n");
    out.commit();
  }
  return names;
}

}  // namespace tet4d::report
