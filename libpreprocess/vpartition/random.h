// Random numbers that are the same everywhere. Private to vpartition.
#pragma once

#include <cstdint>

namespace tet4d::vpartition {

// SplitMix64 (Steele et al. 2014); the state is any number.
inline std::uint64_t nextRandom(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15U;
  std::uint64_t z = state;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9U;
  z = (z ^ z >> 27) * 0x94D049BB133111EBU;
  return z ^ z >> 31;
}

// 0 .. below - 1; below < 2^32 keeps the bias under 2^-32.
inline std::uint64_t nextRandom(std::uint64_t& state, std::uint64_t below) { return nextRandom(state) % below; }

}  // namespace tet4d::vpartition
