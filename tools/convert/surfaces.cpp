#include "tools/convert/surfaces.h"

#include <cstdio>
#include <string>

#include "libpreprocess/exchange/write_surfaces.h"

namespace tet4d::convert {

void convertSurfaces(cli::Session& session, const Options& options) {
  const std::string& output = session.options().output;
  if (suffixOf(output) != ".t4q") failUsage("meshes cannot be written as \"" + output + "\"");
  if (options.wantsSlices() || !options.sliceOption().empty()) {
    failUsage("slices are of a hypermesh", "make one first: tet4d-mc MESHES -o X.t4h");
  }
  if (const std::string option = frames::volumeOption(options.frames); !option.empty())
    failUsage(option + " is for volumes, and this is a mesh", "leave it out");
  const auto source = exchange::openSurfaces(
      options.inputs, {options.frames.allow_gaps, frames::givenTimes(options.frames.times, "--frame-times", session)});
  const exchange::SurfaceInfo& info = source->info();
  const auto provenance = [&](std::uint64_t digest) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest));
    const cli::Input input{"surfaces", text};  // whatever the files are called
    return session.provenance({&input, 1});
  };
  exchange::writeSurfaceSequence(output, *source, options.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw,
                                 session.options().force, provenance, session.progress());
  session.stats().count("frames", info.times.size());
  session.stats().count("vertices", info.vertices);
  session.stats().count("triangles", info.triangles.size());
  session.note(std::to_string(info.times.size()) + " frames of " + std::to_string(info.vertices) + " vertices, " +
               std::to_string(info.triangles.size()) + " triangles");
}

}  // namespace tet4d::convert
