// The sweeps of tet4d-report: programs over options and inputs, errors measured beside the runs.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/report/page.h"

namespace tet4d::report {

// What every sweep is given.
struct Bench {
  cli::Session& session;
  const Programs& programs;
  Rows& rows;
  std::string work;  // an existing folder; children run in it
  bool full = false;
  std::uint64_t repeat = 1;
};

// A ball that moves and grows, sampled as its distance field: N samples an axis over the unit cube, F frames over unit
// time. Closed forms for everything measured.
struct Ball {
  std::size_t samples = 65, frames = 17;
  double noise = 0;  // cells, added to the samples, evenly spread
  std::array<double, 3> centreAt(double time) const;
  double radiusAt(double time) const;
  // Raw float32, x fastest, frame after frame.
  void write(const std::string& path) const;
};

// tet4d-mc on the ball with strides in space and time: slices against the sphere, at frames and between.
Section sweepBall(Bench& bench);
// … on frames of a volume, against the slices of all of them.
Section sweepFrames(Bench& bench, const std::vector<std::string>& inputs, const std::string& iso);
// … on the ball with anisotropic cells, far origins, units of time, noise. Errors in cells.
Section sweepStiff(Bench& bench);

struct PlayOptions {
  std::vector<std::string> inputs;
  std::vector<std::string> vary;  // "OPTION=V,V,V"
  std::array<std::uint32_t, 2> size{480, 270};
  std::string times, camera;
  double orbit_degrees = 20;
};
// tet4d-play over all combinations of options, against the pictures of the most samples.
Section sweepPlay(Bench& bench, const PlayOptions& options);

// XXH3 of a file, or of the digests of several.
std::string digestOf(const std::vector<std::string>& files);

}  // namespace tet4d::report
