// What may be written where. Private to tools/common.
#pragma once

#include "tools/common/cli.h"

namespace tet4d::cli {

// Throws Error{kUsage}, naming both, if an output (-o, kIsOutput) is the same file as an input (a positional, an option
// whose value is FILE, kIsInput) or as another output; if it is a file that a pattern among the inputs may mean; or if
// it exists in a directory given as input and may be one of its frames: with --force any -o there, and what has a
// volume's suffix. Files are the same if the system says so, or, where there is none yet, if their paths lead to the
// same place. Devices, pipes and standard streams are nobody's own.
void refuseOverlaps(const Command& command);

}  // namespace tet4d::cli
