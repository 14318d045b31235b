#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "formats/dynamic_triangles.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/read_png.h"
#include "libpreprocess/measure/picture_error.h"
#include "tools/report/sweeps.h"

namespace tet4d::report {
namespace {

namespace fs = std::filesystem;

struct Varied {
  std::string option;  // without dashes
  std::vector<std::string> values;
};

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::vector<Varied> variedOf(const std::vector<std::string>& texts) {
  std::vector<Varied> all;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw Error(FaultCode::kUsage, "", "--vary '" + text + "'", "is not OPTION=V,V,V", "write --vary samples=1,4,16");
    }
    all.push_back({text.substr(0, equals), split(text.substr(equals + 1))});
  }
  return all;
}

// A value of each option, all combinations, the last option fastest.
std::vector<std::vector<std::string>> combinations(const std::vector<Varied>& varied) {
  std::vector<std::vector<std::string>> all{{}};
  for (const Varied& one : varied) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& chosen : all) {
      for (const std::string& value : one.values) {
        longer.push_back(chosen);
        longer.back().push_back(value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

std::string timesOf(const dyntri::File& file, bool full) {
  const double first = file.times().front(), last = file.times().back();
  const int steps = full ? 64 : 16;
  return fmt::format("{}:{}:{}", first, last, (last - first) / steps);
}

measure::PictureView viewOf(const exchange::Picture& picture) { return {picture.width, picture.height, picture.rgba}; }

std::vector<std::string> picturesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end());
  return names;
}

void comparePictures(const std::string& folder, const std::string& exact, Row& row) {
  const std::vector<std::string> names = picturesIn(folder), references = picturesIn(exact);
  if (names.size() != references.size() || names.empty()) return;
  measure::Flicker flicker;
  double squares = 0, most = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const exchange::Picture picture = exchange::readPng(names[k]), reference = exchange::readPng(references[k]);
    const measure::PictureError error = measure::comparePictures(viewOf(picture), viewOf(reference));
    squares += error.rmse * error.rmse;
    most = std::max(most, error.max);
    flicker.add(viewOf(picture), viewOf(reference));
  }
  row["rmse_255"] = number(255 * std::sqrt(squares / static_cast<double>(names.size())));
  row["max_255"] = number(255 * most);
  row["flicker_255"] = number(255 * flicker.rms());
}

void addFrames(const measure::RunRecord& record, Row& row) {
  std::vector<double> ms;
  double drawn = 0, processed = 0, touched = 0;
  for (const auto& frame : record.frames) {
    ms.push_back(frame.ms);
    drawn += static_cast<double>(frame.drawn);
    processed += static_cast<double>(frame.processed);
    touched += static_cast<double>(frame.bytes_touched);
  }
  row["pictures"] = record.frames.size();
  row["ms_p50"] = number(measure::percentile(ms, 0.5));
  row["ms_p95"] = number(measure::percentile(ms, 0.95));
  row["drawn"] = number(drawn);
  row["processed_per_drawn"] = number(drawn > 0 ? processed / drawn : std::nan(""));
  row["touched_bytes"] = static_cast<std::uint64_t>(touched);
}

std::string listed(const std::vector<Varied>& varied, const std::vector<std::string>& values) {
  std::string text;
  for (std::size_t i = 0; i < varied.size(); ++i)
    text += fmt::format("{}{} {}", i > 0 ? ", " : "", varied[i].option, values[i]);
  return text;
}

struct Player {
  Bench& bench;
  std::vector<std::string> words;  // of every run
  ChildRun run(const std::vector<std::string>& more, const std::string& folder, std::uint64_t repeat) const {
    std::error_code ignored;
    fs::remove_all(bench.work + "/" + folder, ignored);
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), {"-o", folder + "/%05d.png", "-f", "-q", "--stats", "stats.json"});
    return bench.programs.median("tet4d-play", all, bench.work + "/stats.json", repeat);
  }
};

void playOne(const Player& player, const std::string& input, const std::string& digest,
             const std::vector<Varied>& varied, const std::vector<std::string>& values) {
  std::vector<std::string> more;
  for (std::size_t i = 0; i < varied.size(); ++i) more.insert(more.end(), {"--" + varied[i].option, values[i]});
  std::vector<std::string> words = player.words;
  words.insert(words.end(), more.begin(), more.end());
  Row row = beginRow("play", input, digest, "tet4d-play", words);
  if (const Row* earlier = player.bench.rows.find(row)) {
    player.bench.rows.add(*earlier);
    return;
  }
  row["varied"] = listed(varied, values);
  for (std::size_t i = 0; i < varied.size(); ++i) row["option " + varied[i].option] = values[i];
  const ChildRun run = player.run(more, "pictures", player.bench.repeat);
  addRun(row, run);
  if (run.record) {
    addFrames(*run.record, row);
    comparePictures(player.bench.work + "/pictures", player.bench.work + "/exact", row);
  }
  player.bench.rows.add(std::move(row));
}

// A series for each value of the first option and each input.
std::vector<Plot> plotsOf(const Rows& rows, const std::vector<Varied>& varied, bool several) {
  Plot error{
      "play-error-ms", "picture error against time a picture", "ms a picture (median)", "RMSE, 255ths", true, true, {}};
  Plot flicker{
      "play-flicker-ms", "flicker against time a picture", "ms a picture (median)", "flicker, 255ths", true, true, {}};
  std::map<std::string, std::pair<Series, Series>> series;
  for (const Row& row : rows.all()) {
    if (row.at("sweep") != "play" || !row.contains("rmse_255")) continue;
    const std::string first = "option " + varied.front().option;
    std::string name = varied.front().option + " " + row.at(first).get<std::string>();
    if (several) name += ", " + row.at("input").get<std::string>();
    std::string label;
    for (std::size_t i = 1; i < varied.size(); ++i) {
      label += fmt::format("{}{} {}", i > 1 ? ", " : "", varied[i].option,
                           row.at("option " + varied[i].option).get<std::string>());
    }
    auto& [a, b] = series[name];
    a.name = b.name = name;
    a.points.push_back({row.at("ms_p50").get<double>(), row.at("rmse_255").get<double>(), label});
    b.points.push_back({row.at("ms_p50").get<double>(), row.at("flicker_255").get<double>(), label});
  }
  for (auto& [name, both] : series) {
    error.series.push_back(std::move(both.first));
    flicker.series.push_back(std::move(both.second));
  }
  return {error, flicker};
}

}  // namespace

Section sweepPlay(Bench& bench, const PlayOptions& options) {
  const std::vector<Varied> varied =
      variedOf(options.vary.empty() ? std::vector<std::string>{"renderer=gl,cpu", "samples=1,4,9"} : options.vary);
  const auto all = combinations(varied);
  bench.session.progress().phase("play", options.inputs.size() * all.size());
  std::uint64_t done = 0;
  for (const std::string& input : options.inputs) {
    const auto file = unwrap(dyntri::File::open(input));
    const std::string path = fs::absolute(input).string(), digest = digestOf({path});
    Player player{bench,
                  {path, "--offscreen", "--size", fmt::format("{}x{}", options.size[0], options.size[1]), "--times",
                   options.times.empty() ? timesOf(file, bench.full) : options.times, "--orbit",
                   fmt::format("{}", options.orbit_degrees)}};
    if (!options.camera.empty())
      player.words.insert(player.words.end(), {"--camera", fs::absolute(options.camera).string()});
    const ChildRun exact = player.run({"--samples", "16"}, "exact", 1);
    if (exact.exit_code != 0) {
      throw Error(FaultCode::kBadInput, input, "", "the exact pictures cannot be drawn: " + exact.fault, "");
    }
    for (const auto& values : all) {
      playOne(player, fs::path(input).filename().string(), digest, varied, values);
      bench.session.progress().step(++done);
    }
  }
  return {
      "tet4d-play",
      "Pictures against those of 16 samples a pixel at full resolution: RMSE in linear light over all pictures, and "
      "flicker, the rms of the second difference in time of the error, in 255ths; ms to draw a picture and read it "
      "back, without writing it.",
      plotsOf(bench.rows, varied, options.inputs.size() > 1),
      {"input", "varied", "pictures", "ms_p50", "ms_p95", "rmse_255", "max_255", "flicker_255", "drawn",
       "processed_per_drawn", "touched_bytes", "peak_bytes", "seconds_wall", "seconds_cpu", "load"},
      "play"};
}

}  // namespace tet4d::report
