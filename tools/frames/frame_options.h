// The options with which programs take frames of a volume, and the source they describe.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libpreprocess/exchange/frame_source.h"
#include "tools/common/cli.h"

namespace tet4d::frames {

// As given; empty means not given.
struct FrameOptions {
  std::string times;  // T,T,… or a file of times
  bool allow_gaps = false;
  std::string array;                                    // of VTK files
  std::string centering;                                // node, cell
  std::string size, type, byte_order, spacing, origin;  // of raw files
  std::uint64_t skip = 0;                               // bytes, of raw files
  std::string crop, stride, range;                      // range: --frames
  std::uint64_t time_stride = 1;
};

// What FRAMES may be, for the help of a positional.
inline constexpr const char* kFramesHelp =
    "volumes in time order (.nrrd, .nhdr, .mha, .mhd, .vti, .pvd, raw with --size), a directory of them, a pattern "
    "such as "
    "a_%04d.nrrd, one file of many frames, a .t4g, or - for standard input";

// Adds the options, under headings of their own. `times_flag` is what the program calls the frames' times. Options that
// describe what files are do not enter provenance, which has a digest of the samples; those that choose a part do.
void addFrameOptions(cli::Command& command, FrameOptions& options, const std::string& times_flag = "--times");

// The times that were given, or none; names their file for --depfile.
std::vector<double> givenTimes(const std::string& argument, const std::string& flag, cli::Session& session);

// The first option given that only volumes have, empty if there is none: all but times and --allow-gaps.
std::string volumeOption(const FrameOptions& options);

// Opens the frames that `inputs` name as the options say, and names the files they come from for --depfile. Throws
// Error{kUsage} for options that make no sense together, and as exchange::openFrames() and viewFrames().
std::unique_ptr<exchange::FrameSource> openFrames(const std::vector<std::string>& inputs, const FrameOptions& options,
                                                  cli::Session& session, const std::string& times_flag = "--times");

}  // namespace tet4d::frames
