// The axes of a NRRD header: which are space and which is time, their positions and times.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/coordinates.h"
#include "libpreprocess/exchange/frame_file.h"
#include "libpreprocess/exchange/nrrd_fields.h"

namespace tet4d::exchange {

// What the header says of its axes.
struct NrrdAxes {
  std::array<std::uint64_t, 3> dims{};
  bool has_frame_axis = false;
  std::uint64_t frames = 1;
  std::vector<std::uint64_t> sizes;  // all axes, a leading scalar axis too
  AffineMap index_to_world;
  std::size_t first_space_axis = 0;  // 1 behind a scalar axis
};

// `centering` is that of space axes whose header tells none. Throws Error{kBadInput} naming the line.
NrrdAxes readNrrdAxes(const NrrdFields& fields, Centering centering);

// World times of the frames, empty if the file tells none. Call it when the sizes are proved against the file.
std::vector<double> readNrrdTimes(const NrrdFields& fields, const NrrdAxes& axes);

}  // namespace tet4d::exchange
