#include "tools/report/slim_run.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libpreprocess/error.h"
#include "tools/report/peer.h"

namespace tet4d::report {
namespace {

void addDistance(const measure::SliceDistance& distance, const std::string& kind, double unit, Row& row) {
  if (distance.slices.empty()) return;  // a mesh of one interval has no inner frames
  row["rms_" + kind] = number(distance.rms / unit);
  row["p99_" + kind] = number(distance.p99 / unit);
  row["max_" + kind] = number(distance.max / unit);
  const auto closed = std::count_if(distance.slices.begin(), distance.slices.end(),
                                    [](const measure::SliceDifference& slice) { return slice.volume_reference != 0; });
  if (closed > 0) row["volume_error_" + kind] = number(distance.volume_error);
  row["closed_slices"] = row.value("closed_slices", std::int64_t{0}) + closed;
}

void judgeSlices(Bench& bench, const measure::SliceSource& slices, measure::SliceJudge& judge, double unit, Row& row) {
  const measure::SplitDistance distance = judge.judge(slices, bench.session.executor(), bench.session.progress());
  addDistance(distance.at, "at", unit, row);
  addDistance(distance.between, "between", unit, row);
}

}  // namespace

void runSlim(Bench& bench, const std::vector<std::string>& words, measure::SliceJudge& judge, double unit, Row& row) {
  std::vector<std::string> all = words;
  all.insert(all.end(), {"--measure", "0", "-o", "slim.t4h", "-f", "-q", "--stats", "stats.json"});
  const ChildRun run = bench.programs.median("hyper-qslim", all, bench.work + "/stats.json", bench.repeat);
  addRun(row, run);
  if (!run.record) return;
  const measure::RunRecord& record = *run.record;
  row["tets"] = record.count("tets");
  row["collapses"] = record.count("collapses");
  const double read = record.phaseSeconds("read"), slim = record.phaseSeconds("simplify"),
               write = record.phaseSeconds("write");
  row["seconds_simplify"] = number(slim);
  row["seconds_work"] = number(read + slim + write);
  const std::string path = bench.work + "/slim.t4h";
  const auto mesh = unwrap(hypermesh::File::open(path));
  if (mesh.header().tets > 0) judgeSlices(bench, measure::slicesOf(mesh), judge, unit, row);
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

void runSlimPeer(Bench& bench, const std::vector<std::string>& words, float last_t, measure::SliceJudge& judge,
                 double unit, Row& row) {
  const PeerRun run = runPeer(bench.programs, words);
  addPeer(row, run);
  row["load"] = loadAverage();
  if (!run.absent.empty() || run.child.exit_code != 0) return;
  row["tets"] = run.line.value("tets", std::uint64_t{0});
  row["seconds_simplify"] = row["seconds_work"] = run.number("seconds_wall");
  const std::string out = bench.work + "/" + words.back();
  if (row["tets"] != 0) {
    const auto points = readValues<Vec4f>(out + ".pts4.f32");
    const auto tets = readValues<hypermesh::Tet>(out + ".tet.i32");
    judgeSlices(bench, measure::slicesOf(points, tets, last_t), judge, unit, row);
  }
  std::error_code ignored;
  for (const char* suffix : {".pts4.f32", ".tet.i32"}) std::filesystem::remove(out + suffix, ignored);
}

}  // namespace tet4d::report
