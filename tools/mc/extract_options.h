// The options of tet4d-mc that say what is extracted from frames of a volume.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"
#include "tools/common/cli.h"
#include "tools/frames/frame_options.h"

namespace tet4d::mc {

// As given.
struct ExtractOptions {
  std::vector<double> isovalues;
  std::string split = "hull", nan = "outside", normals = "none", codec = "raw";
  bool cap = false, velocity = false;
  std::uint64_t pad = 0;
  std::vector<std::string> fields;  // NAME=FRAMES
};

// The first option given that only volumes have, empty if there is none: all but how pages are stored.
std::string extractOption(const ExtractOptions& options);

void addExtractOptions(cli::Command& command, ExtractOptions& options);

// The builder's options with the frames of the fields, which must outlive the run.
struct Extraction {
  hypermesh::Options options;
  std::vector<std::unique_ptr<exchange::FrameSource>> fields;
};

// Opens the fields' frames as `frame_options` say, so that they are cropped and strided like the frames themselves.
// Throws Error{kUsage} for options that make no sense, and as frames::openFrames().
Extraction extractionOf(const ExtractOptions& options, const frames::FrameOptions& frame_options,
                        cli::Session& session);

}  // namespace tet4d::mc
