// What the run and its plan must agree on. Private to the room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "libpreprocess/hypermesh/bit_planes.h"
#include "libpreprocess/hypermesh/marching_hypercubes.h"

namespace tet4d::hypermesh {

// Most isovalues of one run.
inline constexpr std::size_t kMaxParts = 64;

// Most layers of padding.
inline constexpr std::uint64_t kMaxPad = 4096;

GridShape gridShape(const exchange::GridInfo& grid, const Options& options);
// Frames of samples in memory at a time.
std::size_t framesHeld(const Options& options);
// Throws Error{kBadInput}: more frames than f32 frame numbers allow.
[[noreturn]] void refuseFrames(const exchange::FrameSource& source, std::size_t frames);
// Throws Error{kBadInput}: one frame, or none.
[[noreturn]] void refuseSingle(const exchange::FrameSource& source);

// Throws Error{kBadInput} that names the field.
[[noreturn]] void refuseField(const Field& field, const std::string& what);
// Proves that a field's frame, which must be known, is at the frames' time; `times` of the frames, at least two.
void checkFieldTime(const Field& field, std::size_t frame, std::span<const double> times);

}  // namespace tet4d::hypermesh
