// Cameras about the data, so that the error of pictures is not that of one lucky side.
#pragma once

#include <string>
#include <vector>

#include "tools/report/child.h"

namespace tet4d::report {

// Writes cameras of tet4d-play into the folder the programs run in, view-00.json …: what they look at, how far away and
// under which lights is as in `camera`, or as the player fits it to `input` if that is empty; they look from the six
// faces and the eight corners of a cube. `words`: options the fit depends on (--size, --renderer). Returns the names.
// Throws Error kBadInput if the player cannot open the data.
std::vector<std::string> writeCubeViews(const Programs& programs, const std::string& input, const std::string& camera,
                                        const std::vector<std::string>& words);

}  // namespace tet4d::report
