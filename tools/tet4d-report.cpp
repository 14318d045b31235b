// tet4d-report: error against run time, as tables, plots and one page; and single comparisons.
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "tools/common/cli.h"
#include "tools/report/compare.h"
#include "tools/report/sweeps.h"

namespace {

using namespace tet4d;

// What every sweep takes; each command has its own.
struct Options {
  std::vector<std::string> frames;
  std::string data, iso = "0.5", program = "mc";
  report::PlayOptions play;
  report::SlimOptions slim;
  std::string folder, bin = report::ownFolder(), commit;
  bool full = false, quick = false, resume = false, no_peer = false;
  std::uint64_t repeat = 1;
  report::CompareOptions compare;
};

// A folder of this run's own inside the report's, gone with it however the run ends.
class WorkFolder {
 public:
  explicit WorkFolder(const std::string& folder) {
    namespace fs = std::filesystem;
    std::error_code error;
    fs::create_directories(folder, error);
    path_ = fs::absolute(folder + "/.work-XXXXXX").string();
    if (error || ::mkdtemp(path_.data()) == nullptr) {
      const std::string why = error ? error.message() : std::string(std::strerror(errno));
      path_.clear();
      throw Error(FaultCode::kIo, folder, "--folder", "cannot be made or written: " + why, "name a folder");
    }
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

using Sweeps = std::function<std::vector<report::Section>(report::Bench&)>;

int sweep(cli::Session& session, const Options& options, const std::string& title, const Sweeps& sweeps) {
  namespace fs = std::filesystem;
  if (options.full && options.quick) {
    throw Error(FaultCode::kUsage, "", "", "--full and --quick are both given", "leave one of them out");
  }
  const WorkFolder made(options.folder);
  const std::string& work = made.path();
  const report::Programs programs(options.bin.empty() ? "" : fs::absolute(options.bin).string(), work);
  report::Rows rows(options.folder, report::contextOf(options.commit, options.bin, programs), options.resume);
  report::Bench bench{session, programs, rows, work, options.full, options.repeat, !options.no_peer};
  const std::vector<report::Section> sections = sweeps(bench);
  report::writePage(options.folder, title, sections, rows);
  std::uint64_t failed = 0;
  for (const report::Row& row : rows.all()) failed += row.value("exit", 1) != 0 ? 1 : 0;
  session.stats().count("rows", rows.all().size());
  session.stats().count("failed", failed);
  if (failed > 0)
    session.warn(std::to_string(failed) + " of " + std::to_string(rows.all().size()) +
                 " runs failed; the page names them");
  session.note("report: " + options.folder + "/index.html, " + std::to_string(rows.all().size()) + " rows");
  return 0;
}

void addSweepOptions(cli::Command& command, Options& o, const char* folder) {
  o.folder = folder;
  command.heading("Report")
      .option("--folder", "DIR", "where runs.jsonl, runs.csv, plots and index.html go", &o.folder, cli::kKeepsResult)
      .flag("--quick", "few and small runs, about a minute; this is the default", &o.quick)
      .flag("--full", "the whole sweep", &o.full)
      .option("--repeat", "N", "runs of each, of which the one with the median wall time counts", &o.repeat)
      .flag("--resume", "keep the rows in the folder that this build has made already", &o.resume)
      .option("--bin", "DIR", "where the programs are", &o.bin)
      .option("--commit", "TEXT", "what the programs were built from; default: as git says", &o.commit)
      .common({cli::kThreads, cli::kStats});
}

void addPeerOption(cli::Command& command, Options& o) {
  command.flag("--no-peer", "leave out the rows of VTK; where python3-vtk9 is not installed they say so anyway",
               &o.no_peer);
}

void addPlayOptions(cli::Command& command, report::PlayOptions& play) {
  command
      .option("--vary", "OPTION=V,V",
              "an option of tet4d-play and its values; repeat it for combinations; default: "
              "renderer=gl,cpu and samples=1,4,9",
              &play.vary)
      .option("--size", "WxH", "of a picture, pixels", cli::Extent{&play.size})
      .option("--times", "A:B:STEP", "of the pictures; default: 5 over the file, 17 with --full; 17 and 65 of one view",
              &play.times)
      .option("--views", "WHICH",
              "from the faces and corners of a cube about the data, 14 films; or one film as the camera is",
              cli::Choice{&play.views, {"cube", "one"}})
      .option("--camera", "FILE", "as of tet4d-play; views of a cube take its distance and lights", &play.camera)
      .option("--orbit", "DEG", "turn of the camera over a film; default: 20 with --views one, else 0",
              &play.orbit_degrees);
}

void addCompare(cli::Command& command, report::CompareOptions& o) {
  command.positional("A", "the one", &o.a).positional("B", "the other", &o.b).flag("--json", "print JSON", &o.json);
}

std::vector<std::string> framesOf(const Options& o) {
  return o.data.empty() ? o.frames : std::vector<std::string>{o.data};
}

int runStiff(cli::Session& session, const Options& options) {
  using Sweep = report::Section (*)(report::Bench&);
  struct Part {
    const char *name, *title;
    Sweep sweep;
  };
  static constexpr std::array<Part, 3> kParts{{{"mc", "tet4d-mc: stiff cases", report::sweepStiff},
                                               {"dyntri", "dyntri-build: stiff cases", report::sweepStiffTriangles},
                                               {"qslim", "hyper-qslim: stiff cases", report::sweepStiffSlim}}};
  for (const Part& part : kParts) {
    if (options.program != part.name) continue;
    return sweep(session, options, part.title,
                 [&](report::Bench& bench) { return std::vector<report::Section>{part.sweep(bench)}; });
  }
  throw Error(FaultCode::kUsage, "", "'" + options.program + "'",
              "has no sweep of stiff cases; mc, dyntri and qslim have", "tet4d-report stiff mc");
}

}  // namespace

int main(int argc, char** argv) {
  const std::string program = "tet4d-report";
  Options mc_options, stiff_options, slim_options, play_options, all_options, distance_options, picture_options;

  cli::Command mc(program, "Error and run time of tet4d-mc over strides in space and time.");
  mc.subcommand("mc")
      .example("tet4d-report mc --folder report", "on a ball whose slices are known in closed form")
      .example("tet4d-report mc frames/*.nrrd --iso 0.5 --full", "and on frames of your own, against all of them")
      .positional("FRAMES", "volumes in time order, or a directory of them", &mc_options.frames, true)
      .option("--iso", "V", "isovalue of the frames", &mc_options.iso);
  addPeerOption(mc, mc_options);
  addSweepOptions(mc, mc_options, "report-mc");

  cli::Command stiff(program, "Error and run time over aspect ratios, far origins, units of time and noise.");
  stiff.subcommand("stiff")
      .example("tet4d-report stiff mc --full", "aspect 1-1e6, origin 1-1e8, time unit 1e-9-1e9, noise")
      .example("tet4d-report stiff dyntri", "the same cases through dyntri-build, to pictures")
      .example("tet4d-report stiff qslim", "… simplified; slow, fast and no motion, flat pieces of growing size")
      .positional("PROGRAM", "mc, dyntri or qslim", &stiff_options.program);
  addSweepOptions(stiff, stiff_options, "report-stiff");

  cli::Command slim(program, "Error and run time of hyper-qslim over orders, metrics and ratios, beside VTK's filter.");
  slim.subcommand("qslim")
      .example("tet4d-report qslim --folder report", "on blobs that meet and part")
      .example("tet4d-report qslim drop.t4h frames/ cloth/sequence.json --iso 0.5 --full", "and on data of your own")
      .positional("INPUT", "hypermesh (.t4h), directory of frames, or mesh sequence", &slim_options.slim.inputs, true)
      .option("--iso", "V", "isovalue of frames", &slim_options.slim.iso);
  addPeerOption(slim, slim_options);
  addSweepOptions(slim, slim_options, "report-qslim");

  cli::Command play(program, "Time and error of tet4d-play's pictures over combinations of its options.");
  play.subcommand("play")
      .example("tet4d-report play drop.t4d --vary samples=1,4 --vary renderer=gl,cpu", "four combinations")
      .positional("FILE", "dynamic triangles (.t4d); several are compared", &play_options.play.inputs);
  addPlayOptions(play, play_options.play);
  addSweepOptions(play, play_options, "report-play");

  cli::Command all(program, "The sweeps of tet4d-mc and tet4d-play on one page.");
  all.subcommand("all")
      .example("tet4d-report all drop.t4d --data frames/ --iso 0.5", "ball, frames, stiff cases, pictures")
      .positional("FILE", "dynamic triangles (.t4d) to play", &all_options.play.inputs, true)
      .option("--data", "DIR", "frames of a volume for tet4d-mc", &all_options.data)
      .option("--iso", "V", "isovalue of the frames", &all_options.iso);
  addPlayOptions(all, all_options.play);
  addPeerOption(all, all_options);
  addSweepOptions(all, all_options, "report");

  report::CompareOptions &distances = distance_options.compare, &pictures = picture_options.compare;
  cli::Command distance(program, "Distances of two surfaces: max with a proven bound, p99, rms, mean.");
  distance.subcommand("distance").example("tet4d-report distance A.ply B.ply --json", "both ways, world units");
  addCompare(distance, distances);
  distance.option("--tolerance", "D", "between max and its bound; 0: 1e-4 of the diagonal", &distances.tolerance)
      .option("--samples", "N", "of p99, rms and mean", &distances.samples)
      .common({cli::kThreads, cli::kStats});

  cli::Command picture(program, "RMSE and largest error of two pictures, in linear light.");
  picture.subcommand("pictures").example("tet4d-report pictures A.png B.png", "of one size");
  addCompare(picture, pictures);
  picture.common({cli::kStats});

  cli::Suite suite{program, "Error against run time: sweeps, plots, one page; distances of surfaces and pictures.", {}};
  suite.parts.push_back({&mc, [&](cli::Session& session) {
                           return sweep(session, mc_options, "tet4d-mc: error against run time",
                                        [&](report::Bench& bench) {
                                          std::vector<report::Section> sections{report::sweepBall(bench)};
                                          const std::vector<std::string> frames = framesOf(mc_options);
                                          if (!frames.empty())
                                            sections.push_back(report::sweepFrames(bench, frames, mc_options.iso));
                                          return sections;
                                        });
                         }});
  suite.parts.push_back({&stiff, [&](cli::Session& session) { return runStiff(session, stiff_options); }});
  suite.parts.push_back({&slim, [&](cli::Session& session) {
                           return sweep(
                               session, slim_options, "hyper-qslim: error against run time",
                               [&](report::Bench& bench) { return report::sweepSlim(bench, slim_options.slim); });
                         }});
  suite.parts.push_back({&play, [&](cli::Session& session) {
                           return sweep(
                               session, play_options, "tet4d-play: error against run time", [&](report::Bench& bench) {
                                 return std::vector<report::Section>{report::sweepPlay(bench, play_options.play)};
                               });
                         }});
  suite.parts.push_back({&all, [&](cli::Session& session) {
                           return sweep(session, all_options, "tet4d: error against run time",
                                        [&](report::Bench& bench) {
                                          std::vector<report::Section> sections{report::sweepBall(bench)};
                                          const std::vector<std::string> frames = framesOf(all_options);
                                          if (!frames.empty())
                                            sections.push_back(report::sweepFrames(bench, frames, all_options.iso));
                                          if (!all_options.play.inputs.empty())
                                            sections.push_back(report::sweepPlay(bench, all_options.play));
                                          sections.push_back(report::sweepStiff(bench));
                                          return sections;
                                        });
                         }});
  suite.parts.push_back(
      {&distance, [&](cli::Session& session) { return report::compareSurfaces(session, distances); }});
  suite.parts.push_back({&picture, [&](cli::Session& session) { return report::comparePngs(session, pictures); }});
  return cli::run(argc, argv, suite);
}
