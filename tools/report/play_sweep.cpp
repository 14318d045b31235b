#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "formats/dynamic_triangles.h"
#include "libpreprocess/error.h"
#include "libpreprocess/measure/picture_files.h"
#include "tools/report/sweeps.h"
#include "tools/report/views.h"

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

std::string timesOf(const dyntri::File& file, int steps) {
  const double first = file.times().front(), last = file.times().back();
  return fmt::format("{}:{}:{}", first, last, (last - first) / steps);
}

std::vector<std::string> picturesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end());
  return names;
}

// Every view is a film of its own; the worst view shows what the mean over all hides.
void comparePictures(const std::string& folder, const std::string& exact, Row& row) {
  double squares = 0, bends = 0, most = 0, worst = 0;
  const std::vector<std::string> views = picturesIn(folder);
  for (const std::string& view : views) {
    measure::FilmMeter meter;
    measure::addFilm(picturesIn(view), picturesIn(exact + "/" + fs::path(view).filename().string()), meter);
    squares += meter.rmse() * meter.rmse();
    bends += meter.flicker() * meter.flicker();
    worst = std::max(worst, meter.rmse());
    most = std::max(most, meter.max());
  }
  const auto count = static_cast<double>(views.size());
  row["views"] = views.size();
  row["rmse_255"] = number(255 * std::sqrt(squares / count));
  row["rmse_worst_view_255"] = number(255 * worst);
  row["max_255"] = number(255 * most);
  row["flicker_255"] = number(255 * std::sqrt(bends / count));
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
  std::vector<std::string> words;    // of every run
  std::vector<std::string> cameras;  // a run each; "" for the player's own
  std::string cameras_text;          // that tells them from others
  // Pictures in folder/view-NN/. Seconds and frames of all views together; ends with the first that fails.
  ChildRun run(const std::vector<std::string>& more, const std::string& folder, std::uint64_t repeat) const {
    std::error_code ignored;
    fs::remove_all(bench.work + "/" + folder, ignored);
    ChildRun whole;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      const std::string view = fmt::format("{}/view-{:02}", folder, k);
      fs::create_directories(bench.work + "/" + view, ignored);
      std::vector<std::string> all = words;
      if (!cameras[k].empty()) all.insert(all.end(), {"--camera", cameras[k]});
      all.insert(all.end(), more.begin(), more.end());
      all.insert(all.end(), {"-o", view + "/%05d.png", "-f", "-q", "--stats", "stats.json"});
      ChildRun one = bench.programs.median("tet4d-play", all, bench.work + "/stats.json", repeat);
      if (one.exit_code != 0) return one;
      if (k == 0) {
        whole = std::move(one);
        continue;
      }
      whole.seconds_wall += one.seconds_wall;
      whole.seconds_cpu += one.seconds_cpu;
      whole.peak_bytes = std::max(whole.peak_bytes, one.peak_bytes);
      if (!whole.record || !one.record) continue;
      whole.record->peak_bytes = std::max(whole.record->peak_bytes, one.record->peak_bytes);
      whole.record->frames.insert(whole.record->frames.end(), one.record->frames.begin(), one.record->frames.end());
    }
    return whole;
  }
};

void playOne(const Player& player, const std::string& input, const std::string& digest,
             const std::vector<Varied>& varied, const std::vector<std::string>& values) {
  std::vector<std::string> more;
  for (std::size_t i = 0; i < varied.size(); ++i) more.insert(more.end(), {"--" + varied[i].option, values[i]});
  std::vector<std::string> words = player.words;
  words.insert(words.end(), more.begin(), more.end());
  Row row = beginRow("play", input, digest, "tet4d-play", words);
  row["case"] = player.cameras_text;
  if (player.bench.rows.take(row)) return;
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

// The cameras of a file, as `options` ask for them.
void setCameras(const PlayOptions& options, const std::string& path, const std::string& size, Player& player) {
  const std::string camera = options.camera.empty() ? "" : fs::absolute(options.camera).string();
  const std::string which = camera.empty() ? "fitted" : digestOf({camera});
  if (options.views == "one") {
    player.cameras = {camera};
    player.cameras_text = "one view, camera " + which;
  } else {
    player.cameras = writeCubeViews(player.bench.programs, path, camera, {"--size", size});
    player.cameras_text = fmt::format("{} views, camera {}", player.cameras.size(), which);
  }
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
    const std::string size = fmt::format("{}x{}", options.size[0], options.size[1]);
    const bool one = options.views == "one";
    const int steps = bench.full ? (one ? 64 : 16) : (one ? 16 : 4);
    Player player{
        bench,
        {path, "--offscreen", "--size", size, "--times", options.times.empty() ? timesOf(file, steps) : options.times,
         "--orbit", fmt::format("{}", options.orbit_degrees.value_or(one ? 20 : 0))},
        {},
        {}};
    setCameras(options, path, size, player);
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
      "Pictures against those of 16 samples a pixel at full resolution, from the six faces and eight corners of a cube "
      "(or one view, if asked for): RMSE in linear light over all pictures, that of the worst view, and "
      "flicker, the rms of the second difference in time of the error, in 255ths; ms to draw a picture and read it "
      "back, without writing it.",
      plotsOf(bench.rows, varied, options.inputs.size() > 1),
      {"input", "varied", "views", "pictures", "ms_p50", "ms_p95", "rmse_255", "rmse_worst_view_255", "max_255",
       "flicker_255", "drawn", "processed_per_drawn", "touched_bytes", "peak_bytes", "seconds_wall", "seconds_cpu",
       "load"},
      "play"};
}

}  // namespace tet4d::report
