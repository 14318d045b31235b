#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>

#include "formats/hypermesh.h"
#include "libpreprocess/error.h"
#include "tools/report/slim_run.h"

namespace tet4d::report {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kColumns{"program",
                                        "order",
                                        "metric",
                                        "choices",
                                        "threads",
                                        "ratio",
                                        "reached",
                                        "tets",
                                        "collapses",
                                        "seconds_work",
                                        "seconds_simplify",
                                        "seconds_wall",
                                        "seconds_cpu",
                                        "peak_bytes",
                                        "unit",
                                        "rms_at",
                                        "p99_at",
                                        "max_at",
                                        "rms_between",
                                        "p99_between",
                                        "max_between",
                                        "volume_error_at",
                                        "volume_error_between",
                                        "closed_slices",
                                        "load",
                                        "stall",
                                        "absent"};

constexpr std::uint64_t kUsualChoices = 8;  // of the series that stands beside the other orders
constexpr double kReached = 1.01;           // of the tetrahedra asked for; what ends above that has stalled

// A hypermesh to simplify, and what its errors are told in.
struct Input {
  std::string name, digest, path;
  std::uint64_t tets = 0;
  double unit = 1;  // world
  std::string unit_name;
};

// One run: what varies.
struct Kind {
  std::string order, metric = "slice";
  std::optional<std::uint64_t> choices, threads;
};

std::string nameOf(const Kind& kind) {
  std::string name = kind.order;
  if (kind.choices && *kind.choices != kUsualChoices) name += fmt::format(" of {}", *kind.choices);
  if (kind.threads) name += fmt::format(", {} thread{}", *kind.threads, *kind.threads == 1 ? "" : "s");
  return kind.metric == "slice" ? name : name + ", " + kind.metric;
}

void run(const ChildRun& child, const std::string& input) {
  if (child.exit_code != 0) throw Error(FaultCode::kBadInput, input, "", "becomes no hypermesh: " + child.fault, "");
}

// Blobs if there is no input; what is no hypermesh goes through tet4d-mc.
Input inputOf(Bench& bench, const SlimOptions& options, const std::string& given) {
  Input input;
  std::vector<std::string> words;
  if (given.empty()) {
    Blobs blobs;
    if (bench.full) blobs.samples = 64, blobs.frames = 32;
    const std::string n = std::to_string(blobs.samples), file = "blobs.f32";
    blobs.write(bench.work + "/" + file);
    input.name = fmt::format("blobs {}^3 x {}", n, blobs.frames);
    input.digest = digestOf({bench.work + "/" + file});
    words = {file, "--size", fmt::format("{0},{0},{0}", n), "--type", "f32", "--iso", "0.5"};
  } else {
    const fs::path path = fs::absolute(given).lexically_normal();
    const fs::path last = path.has_filename() ? path : path.parent_path();
    input.name = last.filename() == "sequence.json" ? last.parent_path().filename() : last.stem();
    input.path = last.string();
    if (last.extension() == ".t4h") {
      input.digest = digestOf({input.path});
    } else {
      words = {input.path};
      // A directory of frames has isovalues, meshes that move have none.
      if (fs::is_directory(last)) words.insert(words.end(), {"--iso", options.iso});
    }
  }
  if (!words.empty()) {
    input.path = bench.work + "/input.t4h";
    words.insert(words.end(), {"-o", input.path, "-f", "-q"});
    run(bench.programs.run("tet4d-mc", words), given);
    if (input.digest.empty()) input.digest = digestOf({input.path});
  }
  return input;
}

// How far a run came, and in words where that is not as far as asked.
void addReached(double ratio, Row& row) {
  if (!row.contains("tets")) return;  // failed, or absent
  const auto tets = row.at("tets").get<double>(), whole = row.at("tets_in").get<double>();
  row["reached"] = number(tets / whole);
  if (tets > kReached * ratio * whole)
    row["stall"] = fmt::format("ends at {:.3g} % of the tetrahedra, asked for {:g} %", 100 * tets / whole, 100 * ratio);
}

void runKind(Bench& bench, const Input& input, const Kind& kind, double ratio, measure::SliceJudge& judge) {
  std::vector<std::string> words{input.path, "--ratio",  fmt::format("{}", ratio), "--order", kind.order,
                                 "--metric", kind.metric};
  if (kind.choices) words.insert(words.end(), {"--choices", std::to_string(*kind.choices)});
  if (kind.threads) words.insert(words.end(), {"--threads", std::to_string(*kind.threads)});
  Row row = beginRow("qslim " + input.name, input.name, input.digest, "hyper-qslim", words);
  if (bench.rows.take(row)) return;
  row["series"] = nameOf(kind);
  row["order"] = kind.order;
  row["metric"] = kind.metric;
  if (kind.choices) row["choices"] = *kind.choices;
  row["ratio"] = ratio;
  row["tets_in"] = input.tets;
  row["unit"] = input.unit_name;
  runSlim(bench, words, judge, input.unit, row);
  addReached(ratio, row);
  bench.rows.add(std::move(row));
}

void runPeers(Bench& bench, const Input& input, const std::vector<double>& ratios, float last_t,
              measure::SliceJudge& judge) {
  const std::string base = "peer-in.hyper";
  const ChildRun made = bench.programs.run("tet4d-convert", {input.path, "-o", base, "-f", "-q"});
  for (const double ratio : ratios) {
    const std::vector<std::string> words{"decimate", base, fmt::format("{}", ratio), "peer-out"};
    Row row = beginRow("qslim " + input.name, input.name, input.digest, "vtkUnstructuredGridQuadricDecimation", words);
    if (bench.rows.take(row)) continue;
    row["series"] = "VTK";
    row["order"] = "VTK";
    row["ratio"] = ratio;
    row["tets_in"] = input.tets;
    row["unit"] = input.unit_name;
    if (made.exit_code != 0) {
      addRun(row, made);
    } else {
      runSlimPeer(bench, words, last_t, judge, input.unit, row);
      addReached(ratio, row);
    }
    bench.rows.add(std::move(row));
  }
  std::error_code ignored;
  for (const char* suffix : {".pts4.f32", ".tet.i32"}) fs::remove(bench.work + "/" + base + suffix, ignored);
}

// Files have names of few characters.
std::string fileName(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    if (plain || (!out.empty() && out.back() != '-')) out += plain ? c : '-';
  }
  return out;
}

// column over column, a series for each that `shown` picks.
Plot plotOf(const Bench& bench, const Input& input, Plot plot, const std::string& x, const std::string& y,
            bool choices) {
  plot.name = "qslim-" + fileName(input.name) + plot.name;
  plot.title = input.name + ": " + plot.title;
  for (const Row& row : bench.rows.all()) {
    if (row.at("sweep") != "qslim " + input.name || !row.contains(x) || !row.contains(y)) continue;
    if (!row.at(x).is_number() || !row.at(y).is_number()) continue;
    const bool of_choices = row.contains("choices");
    if (choices && (!of_choices || row.at("metric") != "slice")) continue;
    if (!choices && of_choices && row.at("choices") != kUsualChoices) continue;
    const auto ratio = row.at("ratio").get<double>();
    const std::string name = choices ? fmt::format("to {:g} %", 100 * ratio) : row.value("series", std::string("?"));
    auto found = std::find_if(plot.series.begin(), plot.series.end(), [&](const Series& s) { return s.name == name; });
    if (found == plot.series.end()) found = plot.series.insert(plot.series.end(), {name, {}});
    const std::string label = choices ? fmt::format("{}", row.at("choices").get<std::uint64_t>())
                              : name == "VTK" || plot.series.front().name == name ? fmt::format("{:g} %", 100 * ratio)
                                                                                  : "";
    found->points.push_back({row.at(x).get<double>(), row.at(y).get<double>(), label});
  }
  return plot;
}

Section sectionOf(const Bench& bench, const Input& input) {
  const std::string length = "rms distance between frames, " + input.unit_name;
  Section section;
  section.heading = "hyper-qslim: " + input.name;
  section.text = fmt::format(
      "{} tetrahedra, simplified by three orders of collapses under two metrics. Slices of the result against those of "
      "the input, both ways (the worse counts), at frames and between them; rms is the mean over the times, p99 and "
      "max "
      "the largest; volumes, where both slices are closed and wound one way, relative. seconds work: reading, "
      "simplifying, writing. VTK: its "
      "quadric filter on (x, y, z; t), seconds of the filter alone, one thread. A run that ends with more tetrahedra "
      "than asked for says so under stall.",
      input.tets);
  section.plots = {
      plotOf(bench, input,
             {"-error-seconds",
              "error between frames against run time",
              "seconds to read, simplify, write",
              length,
              true,
              true,
              {}},
             "seconds_work", "rms_between", false),
      plotOf(bench, input, {"-error-tets", "error between frames against size", "tetrahedra", length, true, true, {}},
             "tets", "rms_between", false),
      plotOf(bench, input,
             {"-choices",
              "multichoice: error against run time, labelled by choices",
              "seconds to read, simplify, write",
              length,
              true,
              true,
              {}},
             "seconds_work", "rms_between", true)};
  section.columns = kColumns;
  section.sweep = "qslim " + input.name;
  return section;
}

std::vector<double> ratiosOf(bool full) {
  if (full) return {0.5, 0.25, 0.1, 0.05, 0.02, 0.01, 0.005};
  return {0.5, 0.1, 0.02};
}

std::vector<std::pair<Kind, std::vector<double>>> planOf(bool full) {
  const std::vector<double> ratios = ratiosOf(full);
  const std::vector<double> few = full ? std::vector<double>{0.1, 0.02} : std::vector<double>{0.1};
  std::vector<std::pair<Kind, std::vector<double>>> plan;
  for (const char* metric : {"slice", "paper"}) {
    for (const char* order : {"passes", "multichoice", "heap"}) {
      const bool chooses = std::string(order) == "multichoice";
      plan.push_back({{order, metric, chooses ? std::optional(kUsualChoices) : std::nullopt, {}}, ratios});
    }
  }
  plan.push_back({{"passes", "slice", {}, 1}, full ? ratios : few});
  for (const std::uint64_t choices :
       full ? std::vector<std::uint64_t>{1, 2, 4, 16, 32, 64} : std::vector<std::uint64_t>{2, 32})
    plan.push_back({{"multichoice", "slice", choices, {}}, few});
  return plan;
}

Section sweepInput(Bench& bench, const SlimOptions& options, const std::string& given) {
  Input input = inputOf(bench, options, given);
  const auto mesh = unwrap(hypermesh::File::open(input.path));
  const auto& header = mesh.header();
  if (header.tets == 0)
    throw Error(FaultCode::kBadInput, given, "", "has no tetrahedra", "give another isovalue: --iso");
  input.tets = header.tets;
  const auto [low, high] = header.domain;
  if ((header.flags & hypermesh::kOnGrid) != 0) {
    input.unit = std::cbrt(std::abs(cellVolume(header.index_to_world)));
    input.unit_name = "cells";
  } else {
    const auto a = toWorld(header.index_to_world, {low.x, low.y, low.z}),
               b = toWorld(header.index_to_world, {high.x, high.y, high.z});
    input.unit = 1e-3 * std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    input.unit_name = "thousandths of the diagonal";
  }
  measure::SliceJudge judge(measure::slicesOf(mesh), measure::sampleTimes(mesh.header().domain, bench.full ? 4 : 2),
                            {header.index_to_world, {low.x, low.y, low.z}},
                            {1e-2 * input.unit, bench.full ? 100'000U : 20'000U, 1'000'000});
  for (const auto& [kind, ratios] : planOf(bench.full)) {
    for (const double ratio : ratios) runKind(bench, input, kind, ratio, judge);
  }
  if (bench.peer) runPeers(bench, input, ratiosOf(bench.full), high.t, judge);
  return sectionOf(bench, input);
}

}  // namespace

std::vector<Section> sweepSlim(Bench& bench, const SlimOptions& options) {
  std::vector<Section> sections;
  for (const std::string& input : options.inputs.empty() ? std::vector<std::string>{""} : options.inputs)
    sections.push_back(sweepInput(bench, options, input));
  return sections;
}

}  // namespace tet4d::report
