// The ball in worlds that are hard on numbers: what the sweeps of stiff cases share.
#pragma once

#include <string>
#include <vector>

#include "libpreprocess/exchange/world_mesh.h"
#include "tools/report/sweeps.h"

namespace tet4d::report {

// How a ball of unit cells is placed in the world.
struct StiffCase {
  std::string what;
  double value = 0;
  Ball ball;
  double aspect = 1, origin = 0, time_unit = 1;
};

// Cells longer along z, an origin far away, another unit of time, noise in cells: a few of each, or many.
std::vector<StiffCase> worldCases(const Ball& ball, bool full, double farthest);

struct StiffInput {
  std::string name, digest;
  std::vector<std::string> words;  // of tet4d-mc, but for -o
};
// Writes the samples into the folder that programs run in, unless they are there.
StiffInput writeCase(const StiffCase& one, const std::string& work);

// A point of the world back in cells; z too, whatever the aspect.
void toCells(const StiffCase& one, exchange::WorldMesh& slice);

// A plot's points, a series for each case: row.at(column) over row.at("value"), of the rows of `sweep` that pass.
Plot stiffPlot(const Rows& rows, const std::string& sweep, const std::string& column, Plot plot);

}  // namespace tet4d::report
