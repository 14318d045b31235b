// A run of hyper-qslim, or of the peer, and its slices judged: what its sweeps share.
#pragma once

#include <string>
#include <vector>

#include "libpreprocess/measure/slice_distance.h"
#include "tools/report/sweeps.h"

namespace tet4d::report {

// Runs hyper-qslim on a hypermesh in the working folder, or elsewhere by an absolute path, and adds to `row`: seconds
// of its phases, tetrahedra, and what the judge says, lengths divided by `unit`.
void runSlim(Bench& bench, const std::vector<std::string>& words, measure::SliceJudge& judge, double unit, Row& row);
// VTK's filter on IN.pts4.f32, IN.tet.i32 of the working folder.
void runSlimPeer(Bench& bench, const std::vector<std::string>& words, float last_t, measure::SliceJudge& judge,
                 double unit, Row& row);

}  // namespace tet4d::report
