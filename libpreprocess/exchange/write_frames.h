// Sequences of frames out: the project's own grid4, and one 4D NRRD.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "formats/grid4.h"
#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/outofcore/progress.h"

namespace tet4d::exchange {

// Makes the provenance (JSON) from the digest of the frames' samples: XXH3-64 of the frames' XXH3-64s, in order.
using ProvenanceOf = std::function<std::string(std::uint64_t digest)>;

// Frames into a .t4g, in order, one in memory, of a stream too. Reports the phase "write".
void writeGrid4(const std::string& path, FrameSource& frames, paged::Codec codec, bool force,
                const ProvenanceOf& provenance, outofcore::Progress& progress);

// Frames into one 4D NRRD with attached raw data, frames along the last axis. The grid stands in "space directions",
// times in the key `times` and, where they are evenly spaced, in the frame axis too. One layer in memory; "-" is
// standard output. Throws Error{kUsage} for a stream, whose count the header would have to tell.
void writeNrrd(const std::string& path, FrameSource& frames, bool force, outofcore::Progress& progress);

}  // namespace tet4d::exchange
