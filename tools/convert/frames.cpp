#include "tools/convert/frames.h"

#include <cstdint>
#include <cstdio>
#include <string>

#include "libpreprocess/exchange/write_frames.h"

namespace tet4d::convert {
namespace {

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

}  // namespace

void convertFrames(cli::Session& session, const Options& options) {
  const std::string& output = session.options().output;
  const std::string suffix = output == "-" ? ".nrrd" : suffixOf(output);
  if (suffix != ".t4g" && suffix != ".nrrd") failUsage("frames cannot be written as \"" + output + "\"");
  if (options.wantsSlices() || !options.sliceOption().empty()) {
    failUsage(
        (options.wantsSlices() ? "--at and --times are" : options.sliceOption() + " is") + " for slices of a hypermesh",
        "make one first: tet4d-mc FRAMES --iso V -o X.t4h");
  }
  const auto frames = frames::openFrames(options.inputs, options.frames, session, "--frame-times");
  if (suffix == ".t4g") {
    const paged::Codec codec = options.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw;
    const auto provenance = [&](std::uint64_t digest) {
      const cli::Input input{"frames", hex(digest)};  // whatever the files are called
      return session.provenance({&input, 1});
    };
    exchange::writeGrid4(output, *frames, codec, session.options().force, provenance, session.progress());
  } else {
    exchange::writeNrrd(output, *frames, session.options().force, session.progress());
  }
  session.stats().count("frames", frames->times().size());
  session.stats().count("voxels", frames->grid().voxels());
  session.note(std::to_string(frames->times().size()) + " frames of " + std::to_string(frames->grid().voxels()) +
               " voxels");
}

}  // namespace tet4d::convert
