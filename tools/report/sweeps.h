// The sweeps of tet4d-report: programs over options and inputs, errors measured beside the runs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
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
  bool peer = true;  // VTK's filters beside ours
};

// A ball that moves and grows, sampled as its distance field: N samples an axis over the unit cube, F frames over unit
// time. Closed forms for everything measured.
struct Ball {
  std::size_t samples = 65, frames = 17;
  double noise = 0;  // cells, added to the samples, evenly spread
  // Off the lattice of every stride, and along no axis.
  std::array<double, 3> centre{0.413, 0.447, 0.551}, velocity{0.171, 0.097, -0.073};
  double radius = 0.263, growth = 0.031;
  std::array<double, 3> centreAt(double time) const;
  double radiusAt(double time) const;
  // Raw float32, x fastest, frame after frame.
  void write(const std::string& path) const;
};

// Gaussians on closed paths, that meet and part; the isosurface at 0.5 is closed, but for what leaves the cube. The
// field of scripts/bench/mc.py in kind: its topology changes, which the ball's does not.
struct Blobs {
  std::size_t samples = 27, frames = 10;
  void write(const std::string& path) const;
};

// tet4d-mc on the ball with strides in space and time: slices against the sphere, at frames and between.
Section sweepBall(Bench& bench);
// … on frames of a volume, against the slices of all of them.
Section sweepFrames(Bench& bench, const std::vector<std::string>& inputs, const std::string& iso);
// … on the ball with anisotropic cells, far origins, units of time, noise. Errors in cells.
Section sweepStiff(Bench& bench);

// dyntri-build and the player's pictures of the same cases: against those of the ball of unit cells, and the renderers
// apart.
Section sweepStiffTriangles(Bench& bench);
// hyper-qslim of the same cases, and of slow, fast and no motion and of flat regions of growing size. Errors in cells.
Section sweepStiffSlim(Bench& bench);

struct SlimOptions {
  std::vector<std::string> inputs;  // hypermeshes, mesh sequences, directories of frames; none: blobs
  std::string iso = "0.5";          // of the frames
};
// hyper-qslim over orders, metrics, ratios and choices, and VTK's filter; a section an input.
std::vector<Section> sweepSlim(Bench& bench, const SlimOptions& options);

struct PlayOptions {
  std::vector<std::string> inputs;
  std::vector<std::string> vary;  // "OPTION=V,V,V"
  std::array<std::uint32_t, 2> size{480, 270};
  std::string times, camera;
  std::string views = "cube";           // or "one"
  std::optional<double> orbit_degrees;  // default: none with views of a cube, 20 with one
};
// tet4d-play over all combinations of options, against the pictures of the most samples, from 14 sides.
Section sweepPlay(Bench& bench, const PlayOptions& options);

// XXH3 of a file, or of the digests of several.
std::string digestOf(const std::vector<std::string>& files);

}  // namespace tet4d::report
